# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""What the export of a .blend is made of; export_film.py begins."""
