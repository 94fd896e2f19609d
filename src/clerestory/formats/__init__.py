"""Readers that convert OBJ, glTF, MGF, HBJSON and photometric files to scenes."""
