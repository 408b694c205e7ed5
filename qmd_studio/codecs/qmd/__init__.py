"""The QMD format of Chattopadhyay, Bhandarkar and Li (VRST'05): tables, encoders, container."""
