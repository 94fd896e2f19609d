"""Readers of OBJ, glTF, MGF, HBJSON and photometric files, as plain scenes."""
