"""``vines recover`` and ``vines browse`` on the command line."""

import json
import shutil


def test_recover_says_what_was_saved_and_lost(quickstart, tmp_path):
    log = next(iter(sorted(quickstart.data.rglob("*.mcap"))))
    damaged = tmp_path / "damaged.mcap"
    shutil.copy(log, damaged)
    damaged.write_bytes(damaged.read_bytes()[: damaged.stat().st_size * 2 // 3])
    done = quickstart.vines("recover", damaged)
    assert done.stdout.startswith(f"wrote {tmp_path / 'damaged.recovered.mcap'}\n")
    assert "saved  /state: " in done.stdout
    assert "lost   the end of the file" in done.stdout
    again = quickstart.vines("recover", damaged, check=False)
    assert again.returncode == 2
    assert "exists and is not overwritten" in again.stderr
    told = json.loads(quickstart.vines("recover", damaged, "--out", tmp_path / "other.mcap", "--json").stdout)
    assert told["path"] == str(tmp_path / "other.mcap")
    assert told["lost"]
    refused = quickstart.vines("recover", log, check=False)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert "is intact" in refused.stderr


def test_wrong_use_is_one_line(project):
    done = project.vines("browse", check=False)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "there are no logs" in done.stderr
    done = project.vines("view", "x.mcap", "--web", "--png", "x.png", check=False)
    assert done.returncode == 2
    assert "--web serves until Ctrl-C" in done.stderr
