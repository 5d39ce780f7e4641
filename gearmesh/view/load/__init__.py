"""Pictures and figures of gears under load and of finite-element solutions."""
