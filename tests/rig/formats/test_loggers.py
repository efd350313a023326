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
