"""Where the original files come from: the user's folder, the cache, the network; always with their sha256."""

import shutil
import socket

import pytest

from npslam_teach import datasets
from npslam_teach.datasets import download

FETCHERS = [
    (datasets.fetch_mu2016_simulation, "mu2016_simulation.mat", "simulation.mat"),
    (datasets.fetch_stata_office, "mu2016_stata_office.mat", "stata01162016obj.mat"),
]


@pytest.fixture
def no_network(tmp_path, monkeypatch):
    """An empty cache, and an address at which nobody answers."""
    pooch = pytest.importorskip("pooch")
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        monkeypatch.setattr(download, "_URL", f"http://127.0.0.1:{unused.getsockname()[1]}/data/")
    monkeypatch.setattr(pooch, "os_cache", lambda project: tmp_path / "cache" / project)
    for name in ("http_proxy", "HTTP_PROXY", "all_proxy", "ALL_PROXY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.delenv("NPSLAM_TEACH_DATA", raising=False)
    return tmp_path


@pytest.mark.parametrize(("fetcher", "local_name", "name"), FETCHERS)
def test_fetch_takes_the_file_from_the_named_folder(data_folder, no_network, monkeypatch, fetcher, local_name, name):
    for wanted in (name, local_name):  # theirs alone first, then both: ours is preferred
        shutil.copy(data_folder / local_name, no_network / wanted)
        monkeypatch.setenv("NPSLAM_TEACH_DATA", str(no_network))
        assert fetcher() == no_network / wanted


@pytest.mark.parametrize(("fetcher", "local_name", "name"), FETCHERS)
def test_fetch_checks_the_hash(no_network, monkeypatch, fetcher, local_name, name):
    monkeypatch.setenv("NPSLAM_TEACH_DATA", str(no_network))
    for wrong in (name, local_name):
        (no_network / wrong).write_bytes(b"something else")
        with pytest.raises(ValueError, match="expected the original with sha256 .*, got [0-9a-f]{64}$") as caught:
            fetcher()
        assert str(caught.value).startswith(str(no_network / wrong))


@pytest.mark.parametrize(("fetcher", "local_name", "name"), FETCHERS)
def test_fetch_uses_the_cache(data_folder, no_network, fetcher, local_name, name):
    cached = no_network / "cache" / "npslam_teach" / local_name
    cached.parent.mkdir(parents=True)
    shutil.copy(data_folder / local_name, cached)
    assert fetcher() == cached


@pytest.mark.parametrize(("fetcher", "local_name", "name"), FETCHERS)
def test_fetch_without_a_network_is_one_sentence(no_network, fetcher, local_name, name):
    with pytest.raises(ConnectionError) as caught:
        fetcher()
    message = str(caught.value)
    assert message.startswith(download._URL + name + ": expected to download it, got ")
    assert "NPSLAM_TEACH_DATA" in message and "\n" not in message and len(message) < 400


def test_fetch_refuses_another_file(no_network, monkeypatch):
    pooch = pytest.importorskip("pooch")

    def retrieve(url, known_hash, **options):
        assert known_hash.startswith("sha256:")
        raise ValueError("SHA256 hash of downloaded file does not match")

    monkeypatch.setattr(pooch, "retrieve", retrieve)
    with pytest.raises(
        ValueError, match="simulation.mat: expected the original with sha256 a2e8760a4a68.*, got another"
    ):
        datasets.fetch_mu2016_simulation()


@pytest.mark.parametrize("original", [download._SIMULATION, download._STATA_OFFICE])
def test_the_addresses_are_those_of_the_authors(original):
    assert download._URL == "https://raw.githubusercontent.com/BeipengMu/objectSLAM/master/data/"
    assert len(original.sha256) == 64
