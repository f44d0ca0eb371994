"""What the export of a .blend is made of; export_film.py begins."""
