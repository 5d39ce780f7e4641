"""A pinion and a rack of finite length, and a rack alone: keys, mesh, the rack as a member, data sheet."""
