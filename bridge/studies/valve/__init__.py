"""What a valve designer asks: a seat at a lift, a static curve, whether it sings; numbers, a picture and a table."""
