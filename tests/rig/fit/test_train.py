"""Trains of impacts beside Python's own lists of triples."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from vines.rig.fit import U_PULSE, Train

TRIPLES = st.lists(
    st.tuples(st.floats(0, 10), st.floats(-1, 1), st.sampled_from([1e-7, U_PULSE, 1e-4])), max_size=12
)  # fmt: skip


def train(triples):
    return Train(*np.array(triples, dtype=np.float64).reshape(-1, 3).T)


def triples_of(train):
    return list(zip(train.t, train.dv, train.u, strict=True))


@given(one=TRIPLES, other=TRIPLES)
def test_a_train_is_in_order_and_keeps_what_belongs_together(one, other):
    both = train(one).merged(train(other))
    in_order = sorted(sorted(one, key=lambda each: each[0]) + other, key=lambda each: each[0])
    assert triples_of(both) == in_order
    assert both.heard.tolist() == [u <= U_PULSE for _, _, u in in_order]
    assert triples_of(both.later(-3.0).later(3.0).only(both.heard)) == [
        (t - 3.0 + 3.0, dv, u) for t, dv, u in in_order if u <= U_PULSE
    ]


@given(given=TRIPLES, low=st.floats(0, 10), high=st.floats(0, 10))
def test_parts_of_a_train(given, low, high):
    whole = train(given)
    assert triples_of(whole.between(low, high)) == [each for each in triples_of(whole) if low < each[0] < high]
    t = whole.t.tolist()
    apart = [k for k in range(len(t)) if k == 0 or t[k] - t[k - 1] > 0.5]
    assert whole.apart(0.5).t.tolist() == [t[k] for k in apart]
    near = [min((abs(a - b) for b in t), default=np.inf) for a in (low, high)]
    assert whole.distance(np.array([low, high])).tolist() == near
