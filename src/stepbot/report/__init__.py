"""What was proven and what was not, for people and programs: ``report.json`` and JUnit XML."""
