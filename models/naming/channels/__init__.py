"""What a log tells of, each with its errors, its noise, and what every cause changes in it."""
