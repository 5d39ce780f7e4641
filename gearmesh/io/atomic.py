"""Files that appear whole or not at all, and failures to write them as one clear line.

A file is written under a temporary name in the folder of its target and renamed when it is complete and on disk.
Until then an existing file is untouched. A full disk, an exception or Ctrl-C leaves no temporary file. A killed process
leaves its temporary file, whose name tells the process; the next process that writes into the folder removes it.
All parts of gearmesh write files by this module:

    with whole_file("teeth.png") as temporary:
        picture.save(temporary)
    whole_text("report.json", text)
"""

from __future__ import annotations

import os
import re
import secrets
import shutil
import socket
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from copy import copy
from functools import cache
from pathlib import Path

from gearmesh.errors import GearmeshError, OutputError

PathLike = str | os.PathLike[str]

# .gearmesh-<machine and process namespace>-<process>-<random>, then a suffix, or -was-<name of a retired folder>
_TEMPORARY_NAME = re.compile(r"\.gearmesh-([0-9a-f]{8})-([0-9]{1,10})-[0-9a-f]{12}(?:-was-(.+)|\..*)?", re.DOTALL)


#: words of messages for a file in a scratch folder
SCRATCH_FILE_WORDS = "a temporary file"
#: files and folders that this process has written whole, in the order of writing
_written: list[Path] = []


def keep(path: PathLike) -> None:
    """Count a file that grows by whole lines as written: its lines stay when the process is stopped."""
    _written.append(Path(path))


def written_whole() -> tuple[Path, ...]:
    """Existing files and folders that this process has written, by the paths that callers gave."""
    return tuple(path for path in dict.fromkeys(_written) if path.exists())


@contextmanager
def whole_file(path: PathLike) -> Iterator[Path]:
    """Context giving a temporary path, beside `path` and with its suffix, that becomes `path` on success.

    The temporary file exists and is empty on entry, so that an unwritable folder is found before any work is done.
    A symbolic link is written through. The body should only write. Raises OutputError, with `path` and the reason, when
    `path` cannot be a file, when the body raises an OSError, and when the body writes nothing.
    """
    target = Path(os.path.realpath(path))
    temporary = _temporary_beside(target, target.suffix)
    try:
        with _report_errors(path, temporary):
            _refuse_unless_file(path, target)
            _remove_leftovers(target.parent)
            os.close(os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
            yield temporary
            if not temporary.stat().st_size:
                raise OutputError("cannot write", path, reason="the writer produced nothing")
            _flush_to_disk(temporary)
            os.replace(temporary, target)
            _written.append(Path(path))
    finally:
        with suppress(OSError):  # it may never have existed, and the reason is on its way already
            temporary.unlink()


@contextmanager
def whole_folder(path: PathLike, suffix: str) -> Iterator[Path]:
    """Context giving a new temporary folder that takes the place of the folder `path` on success.

    Formats of several files use this. An existing folder is replaced only if all its files end in `suffix`; it comes back
    if the exchange fails. Raises OutputError as `whole_file` does.
    """
    target = Path(os.path.realpath(path))
    temporary, retired = _temporary_beside(target, target.suffix), _temporary_beside(target, f"-was-{target.name}")
    try:
        with _report_errors(path, temporary):
            _remove_leftovers(target.parent)
            _refuse_unless_replaceable(path, target, suffix)
            temporary.mkdir()
            yield temporary
            for file in temporary.iterdir():
                _flush_to_disk(file)
            _exchange(temporary, target, retired)
            _written.append(Path(path))
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
        shutil.rmtree(retired, ignore_errors=True)


@contextmanager
def files_together(path: PathLike) -> Iterator[Path]:
    """Context giving a temporary folder; on success all its files appear in the folder `path`, otherwise none.

    Files and folders in `path` with other names stay. A new folder replaces an existing one only if that holds no files of
    other suffixes. The temporary folder is inside `path`. A missing `path` is made, and removed again if nothing is written.
    Raises OutputError as `whole_file` does; refusals name the final files.
    """
    target = Path(os.path.realpath(path))
    temporary, known = target / _temporary_beside(target / "files", "").name, len(_written)
    made: list[Path] = []
    try:
        with _report_errors(path, temporary):
            made = _make_folder(target)
            _remove_leftovers(target)
            temporary.mkdir()
            try:
                yield temporary
            except OutputError as refusal:
                raise _under_final_name(target, refusal, temporary) from refusal.__cause__
            entries = sorted(temporary.iterdir(), key=lambda entry: entry.is_file())
            for entry in entries:
                _refuse_in_the_way(entry, Path(path) / entry.name)
            for entry in entries:
                _into_place(entry, target / entry.name)
            _written[known:] = [Path(path) / entry.name for entry in entries]
    finally:
        # files of the temporary folder that did not reach their place were not written
        _written[known:] = [file for file in _written[known:] if temporary not in file.parents]
        shutil.rmtree(temporary, ignore_errors=True)
        for folder in made:
            with suppress(OSError):  # it holds what was written
                folder.rmdir()


def _make_folder(folder: Path) -> list[Path]:
    """Make a folder and its missing parents; return the folders made, the innermost first."""
    missing = [parent for parent in (folder, *folder.parents) if not parent.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    return missing


def _under_final_name(target: Path, refusal: OutputError, temporary: Path) -> OutputError:
    """Refusal with the path in the folder `target` in place of the path in the temporary folder."""
    final_name, temporary_name = str(target), str(temporary)
    refusal.value = str(refusal.value).replace(temporary_name, final_name)
    refusal.reason = refusal.reason.replace(temporary_name, final_name)
    return refusal


def _refuse_in_the_way(new: Path, path: Path) -> None:
    """Refuse a new file or folder whose path holds something that may not be replaced."""
    target = Path(os.path.realpath(path))
    if new.is_file():
        _refuse_unless_file(path, target)
    else:
        for suffix in {file.suffix for file in new.iterdir()}:
            _refuse_unless_replaceable(path, target, suffix)


def _into_place(new: Path, target: Path) -> None:
    """Rename a whole file or folder to its place."""
    if new.is_file():
        os.replace(new, os.path.realpath(target))
        return
    retired = _temporary_beside(target, f"-was-{target.name}")
    try:
        _exchange(new, target, retired)
    finally:
        shutil.rmtree(retired, ignore_errors=True)


def whole_text(path: PathLike, text: str) -> None:
    """Write `text` (UTF-8, line ends as given) to `path`, whole or not at all. Raises OutputError."""
    with whole_file(path) as temporary:
        temporary.write_bytes(text.encode())


@contextmanager
def scratch_folder() -> Iterator[Path]:
    """Context giving a folder that is removed at the end; an OutputError of writing in it does not name the folder."""
    with tempfile.TemporaryDirectory(prefix="gearmesh-") as name:
        try:
            yield Path(name)
        except OSError as error:
            if name not in str(error):
                raise
            raise OutputError("cannot write", SCRATCH_FILE_WORDS, reason=error.strerror or "it failed") from error
        except GearmeshError as failure:
            raise _with_other_name(failure, name, SCRATCH_FILE_WORDS) from failure


@contextmanager
def _report_errors(path: PathLike, temporary: Path) -> Iterator[None]:
    """Turn an OSError into an OutputError naming `path` as the caller wrote it, never the temporary file."""
    try:
        yield
    except OSError as error:
        folder = os.path.dirname(os.path.abspath(path))
        missing = isinstance(error, FileNotFoundError) and not os.path.isdir(folder)
        told = error.strerror or str(error).replace(str(temporary), os.fspath(path))
        reason = f"the folder {folder} does not exist" if missing else told
        raise OutputError("cannot write", path, reason=reason) from error
    except GearmeshError as failure:
        raise _with_other_name(failure, str(temporary), os.fspath(path)) from failure


def _with_other_name(failure: GearmeshError, temporary: str, name: str) -> GearmeshError:
    """Refusal with `name` in place of a temporary path and of paths inside it."""
    if temporary not in str(failure):
        return failure
    made, inside = copy(failure), re.compile(rf"{re.escape(temporary)}[\w./-]*")
    for attribute, value in vars(made).items():
        if isinstance(value, str | Path):
            setattr(made, attribute, inside.sub(lambda _: name, str(value)))
    return made


def _temporary_beside(target: Path, end: str) -> Path:
    """Unused path in the folder of `target` that ends in `end`; some writers choose the format by the suffix."""
    return target.with_name(f".gearmesh-{_place()}-{os.getpid()}-{secrets.token_hex(6)}{end}")


@cache
def _place() -> str:
    """Checksum, eight digits, of the machine and the process namespace; other machines may write into a shared folder."""
    identity = [socket.gethostname()]
    with suppress(OSError):
        identity.append(Path("/etc/machine-id").read_text(encoding="ascii"))
    with suppress(OSError):
        identity.append(os.readlink("/proc/self/ns/pid"))
    return f"{zlib.crc32(' '.join(identity).encode()):08x}"


@cache
def _remove_leftovers(folder: Path) -> None:
    """Remove the temporary files of killed processes from a folder; a retired folder goes back if its place is free.

    A process does this once for each folder. Temporary files of living processes stay, and those of other machines, whose
    processes cannot be asked for.
    """
    if os.name != "posix":
        return  # there is no harmless signal
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in list(entries):
            match = _TEMPORARY_NAME.fullmatch(entry.name)
            if not match or match[1] != _place() or _alive(int(match[2])):
                continue
            with suppress(OSError):
                if match[3] and not os.path.lexists(folder / match[3]):
                    os.rename(entry.path, folder / match[3])
                elif entry.is_dir(follow_symlinks=False):
                    shutil.rmtree(entry.path, ignore_errors=True)
                else:
                    os.unlink(entry.path)


def _alive(process: int) -> bool:
    """True if a process has this number, even one of another user."""
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:
        return True
    return True


def _refuse_unless_file(path: PathLike, target: Path) -> None:
    if target.is_dir():
        raise OutputError("cannot write", path, reason="it is a folder")
    if target.exists() and not target.is_file():
        raise OutputError("cannot write", path, reason="it is not a regular file")


def _refuse_unless_replaceable(path: PathLike, target: Path, suffix: str) -> None:
    if not target.exists():
        return
    if not target.is_dir():
        raise OutputError("cannot write the folder", path, reason="a file has that name")
    if any(entry.is_dir() or entry.suffix != suffix for entry in target.iterdir()):
        raise OutputError("cannot replace the folder", path, reason=f"it holds other files than {suffix}")


def _exchange(new: Path, target: Path, retired: Path) -> None:
    """Rename `new` to `target`, moving an existing `target` to `retired`, or back if that fails."""
    if not target.exists():
        os.rename(new, target)
        return
    os.rename(target, retired)
    try:
        os.rename(new, target)
    except OSError:
        os.rename(retired, target)
        raise


def _flush_to_disk(file: Path) -> None:
    """Wait until the file's contents are on disk: a full disk may show only here."""
    descriptor = os.open(file, os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
