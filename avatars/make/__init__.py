"""The program that makes the avatars that ship."""
