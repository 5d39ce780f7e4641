"""Reports of answers for people: pictures by name, the report page, and the folder of a whole run."""
