"""The whole story in a few minutes, from hiding an effect to unsealing it."""
