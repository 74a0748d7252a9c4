"""What is read and written: scenes, images, packings, fields."""
