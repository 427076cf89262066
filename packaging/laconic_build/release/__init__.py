"""Collects what was built into the folder that is given to others: archives, checksums, licences, bill of materials."""
