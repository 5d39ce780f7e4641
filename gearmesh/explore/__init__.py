"""The local page of `gearmesh explore`, on which gears and figures follow each changed key.

- `server` answers the browser, and nobody else; `workers` keeps the process for heavy work.
- `worker` is that process; `workshop` builds, solves and packs what a page shows.
- `state` is what a page has set; `keys`, `ranges`, `refusals` and `saving` are its parts of the page.
"""
