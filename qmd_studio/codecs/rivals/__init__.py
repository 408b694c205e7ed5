"""What a motion is compared with: the coders that anybody would think of first. None of them is a file format."""
