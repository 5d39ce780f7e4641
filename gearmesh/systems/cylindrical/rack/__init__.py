"""A pinion and a rack of finite length: their keys, what their mesh says of both, the rack as a member, their data
sheet; and a rack alone."""
