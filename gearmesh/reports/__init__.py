"""What answers become for people: pictures by name, the report page, the folder of a whole run."""
