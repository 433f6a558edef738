"""What is kept on disk: whole or not at all, up to a limit, the least recently used dropped first."""
import os

import pytest

from addon.blender.host.store import Store

ONE, TWO, THREE = "1" * 64, "2" * 64, "3" * 64


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path, 100_000)


def at(store, key, seconds):
    os.utime(store.folder / f"{key}.z", (seconds, seconds))


def noise(seed, size=1000):
    import random

    return random.Random(seed).randbytes(size).hex()


def test_values_come_back(store):
    for key, value in ((ONE, "OpenShadingLanguage 1.00\n" * 1000), (TWO, [0.012, -0.001]), (THREE, "größer")):
        assert store.load(key) is None
        store.save(key, value)
        assert store.load(key) == value == Store(store.folder, 1).load(key)
    assert 0 < store.size() < 1000, "text of one line is pressed to little"
    assert sorted(path.name for path in store.folder.iterdir()) == [f"{key}.z" for key in (ONE, TWO, THREE)]
    store.clear()
    assert list(store.folder.iterdir()) == [] and store.load(ONE) is None and store.size() == 0


@pytest.mark.parametrize("spoil", [
    lambda data: b"", lambda data: data[:-1], lambda data: data[: len(data) // 2],
    lambda data: data[:50] + bytes([data[50] ^ 1]) + data[51:], lambda data: b"not compressed at all",
])
def test_a_damaged_entry_is_deleted(store, spoil):
    store.save(ONE, noise(1))
    path = store.folder / f"{ONE}.z"
    path.write_bytes(spoil(path.read_bytes()))
    assert store.load(ONE) is None and not path.exists()
    store.save(ONE, "anew")
    assert store.load(ONE) == "anew"


def test_what_was_not_used_for_longest_is_dropped(store):
    for i, key in enumerate((ONE, TWO)):
        store.save(key, noise(i))
        at(store, key, 100 + i)
    store.limit = 2 * (store.folder / f"{ONE}.z").stat().st_size + 100
    store.load(ONE)  # used now: the other one goes
    store.save(THREE, noise(3))
    assert store.load(TWO) is None and store.load(ONE) == noise(0) and store.load(THREE) == noise(3)
    assert store.size() <= store.limit


def test_what_is_larger_than_the_limit_is_not_kept(store):
    store.save(ONE, "small")
    store.limit = 500
    store.save(TWO, noise(2))
    assert store.load(TWO) is None and store.load(ONE) == "small"


def test_a_failing_write_leaves_nothing(store, monkeypatch):
    def full(self, data):
        raise OSError(28, "No space left on device")

    store.save(ONE, "old")
    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    with pytest.raises(OSError, match="No space"):
        store.save(ONE, "new")
    assert store.load(ONE) == "old" and len(list(store.folder.iterdir())) == 1


def test_foreign_files_are_left_alone(store):
    (store.folder / "notes.txt").write_text("mine")
    left, fresh = store.folder / f".{ONE}.z.1.part", store.folder / f".{TWO}.z.2.part"
    left.write_bytes(b"half")
    fresh.write_bytes(b"being written")
    os.utime(left, (0, 0))
    store.save(THREE, "value")
    assert not left.exists() and fresh.exists()
    store.clear()
    assert sorted(path.name for path in store.folder.iterdir()) == [fresh.name, "notes.txt"]
