"""Rows on disk: nothing that was there is lost, nothing is there twice."""

import json
from pathlib import Path

import pytest

from momantu_bt.bench.rows.store import LOCK, RESULTS, Store, StoreError, read_rows
from momantu_bt.formats.files import OutputError


def row(number: int) -> dict[str, object]:
    return {"key": f"k{number}", "seed": number, "words": "ä\n€" * number}


def test_what_was_added_is_read_again_in_its_order(tmp_path: Path) -> None:
    with Store(tmp_path / "new" / "folder") as store:
        for number in (3, 1, 2):
            store.add(row(number))
        assert list(store.rows) == ["k3", "k1", "k2"]
    assert read_rows(tmp_path / "new" / "folder") == [row(3), row(1), row(2)]
    with Store(tmp_path / "new" / "folder") as store:
        store.add(row(4))
    assert [each["seed"] for each in read_rows(tmp_path / "new" / "folder")] == [3, 1, 2, 4]


def test_a_file_cut_anywhere_keeps_every_whole_row_and_takes_new_ones(tmp_path: Path) -> None:
    with Store(tmp_path) as store:
        for number in range(3):
            store.add(row(number))
    file = tmp_path / RESULTS
    whole = file.read_bytes()
    ends = [at + 1 for at, byte in enumerate(whole) if byte == 10]
    for cut in range(len(whole) + 1):
        file.write_bytes(whole[:cut])
        left = sum(end <= cut for end in ends)
        assert [each["seed"] for each in read_rows(tmp_path)] == list(range(left))
        with Store(tmp_path) as store:
            store.add(row(9))
        assert [each["seed"] for each in read_rows(tmp_path)] == [*range(left), 9]


def test_a_line_in_the_middle_that_is_no_row_is_named(tmp_path: Path) -> None:
    for bad in ("{", "[]", '{"seed": 3}', "null"):
        (tmp_path / RESULTS).write_text(f"{json.dumps(row(1))}\n{bad}\n{json.dumps(row(2))}\n")
        with pytest.raises(StoreError, match=rf"{RESULTS}:2 is not a row"):
            Store(tmp_path)


def test_two_at_a_time_are_refused_and_one_after_the_other_is_not(tmp_path: Path) -> None:
    with Store(tmp_path), pytest.raises(StoreError, match="another bench"):
        Store(tmp_path)
    with Store(tmp_path):
        assert (tmp_path / LOCK).exists()


def test_a_full_disk_leaves_the_rows_before_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import os

    write = os.write

    def half(file: int, data: bytes) -> int:
        return write(file, data[: len(data) // 2])

    with Store(tmp_path) as store:
        store.add(row(1))
        with monkeypatch.context() as patch:
            patch.setattr(os, "write", half)
            with pytest.raises(OutputError, match="cannot be written"):
                store.add(row(2))
        store.add(row(3))
    assert [each["seed"] for each in read_rows(tmp_path)] == [1, 3]


def test_a_place_that_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written"):
        Store(tmp_path / "file")
