"""Files of loggers are read right or refused with a reason; a column is never taken for another."""

import numpy as np
import pytest

from tests.rig.formats.loggers import BASE, COUNT, LO, LOGGERS, T
from vines.errors import RigError
from vines.rig.formats import read_file
from vines.rig.ingest._inspect import channel_facts


@pytest.mark.parametrize("case", LOGGERS.values(), ids=LOGGERS)
def test_files_of_loggers(case, tmp_path):
    path = tmp_path / case.name
    path.write_bytes(case.data)
    if case.refused:
        with pytest.raises(RigError, match=case.refused) as caught:
            read_file(path, case.dialect)
        assert str(caught.value).startswith(path.name)
        assert "\n" not in str(caught.value)
        return
    found = read_file(path, case.dialect)
    assert tuple(each.name for each in found.channels) == case.names
    assert tuple(each.unit for each in found.channels) == case.units
    if case.said not in ("", "lost"):
        assert any(case.said in remark for remark in found.remarks), found.remarks
    columns = {1: [LO], 2: [LO, BASE], 3: [T, LO, BASE]}[len(case.names)]
    if case.names == ("4", "5"):
        columns = [T - 0.1, LO]
    if "integers" in case.name or found.channels[0].values.max() > 100:
        return
    for channel, column in zip(found.channels, columns, strict=True):
        facts = channel_facts(channel)
        assert facts.rate == (None if case.rate is None else pytest.approx(case.rate, rel=1e-9))
        assert ("no numbers" in facts.gaps) == (case.said == "lost" and channel is found.channels[0])
        np.testing.assert_allclose(channel.values[:COUNT], column, atol=0.006)
    if found.dialect:
        again = read_file(path, found.dialect.replace("time_unit=unknown", "").replace("encoding=utf-16-le", ""))
        assert again.channels[0].name == found.channels[0].name
        np.testing.assert_array_equal(again.channels[-1].values, found.channels[-1].values)


def _stamped(path, days, separator="-"):
    """Write two rows a second about midnight, the second half of them so many days later."""
    rows = []
    for k in range(200):
        late = k >= 100
        clock = f"00:00:{(k - 100) / 10:06.3f}" if late else f"23:59:{50 + k / 10:06.3f}"
        day = 2 + days if late else 2
        told = f"{day:02}.03.2026" if separator == "." else f"2026{separator}03{separator}{day:02}"
        rows.append(f"{told} {clock};{np.sin(k):.4f}")
    path.write_text("Time;lo [V]\n" + "\n".join(rows) + "\n")
    return path


@pytest.mark.parametrize("separator", ["-", "/", "."])
def test_dates_are_laid_beside_the_midnights_that_times_pass(tmp_path, separator):
    found = read_file(_stamped(tmp_path / "one.csv", 1, separator))
    assert channel_facts(found.channels[0]).rate == pytest.approx(10.0)
    assert found.started == "2026-03-02T23:59:50.000"
    with pytest.raises(RigError, match=r"from 2026-03-02 to 2026-03-04, its times pass midnight 1 times"):
        read_file(_stamped(tmp_path / "two.csv", 2, separator))
