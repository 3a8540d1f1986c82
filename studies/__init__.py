"""What puts the rooms together: experiments, studies, figures, reports, the command line."""
