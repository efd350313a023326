import itertools
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vines.errors import ParameterError
from vines.model import Word, of_moderate_length

letters = st.text(alphabet="LR", min_size=1, max_size=12)
periods = st.integers(1, 9)


def spell(text: str, p: int) -> str:
    return f"{text}/{p}T"


@given(letters, periods, st.integers(0, 20))
def test_every_rotation_names_the_same_orbit(text, p, k):
    k %= len(text)
    assert Word(spell(text[k:] + text[:k], p)) == Word(spell(text, p))
    assert Word(spell(text, p)).letters <= text


@given(letters, periods)
def test_a_word_reads_its_own_text_and_is_hashable(text, p):
    word = Word(spell(text, p))
    assert Word(str(word)) == word == Word(word) == pickle.loads(pickle.dumps(word))
    assert len({word, Word(str(word))}) == 1
    assert eval(repr(word)) == word


@given(letters, periods)
def test_mirror_swaps_the_sides_and_is_its_own_inverse(text, p):
    word = Word(spell(text, p))
    assert (word.mirror.n, word.mirror.m, word.mirror.p) == (word.m, word.n, word.p)
    assert word.mirror.mirror == word


@given(letters, periods)
def test_symmetric_words_are_their_own_mirror_image(text, p):
    word = Word(spell(text, p))
    if word.symmetric:
        assert word.mirror == word
        assert word.p % 2 == 1


@given(letters, st.integers(1, 4).map(lambda k: 2 * k - 1))
def test_a_first_half_and_its_swap_make_a_symmetric_word(half, p):
    assert Word(spell(half + half.translate(str.maketrans("LR", "RL")), p)).symmetric


@given(letters, periods)
def test_rotations_are_where_the_letters_read_the_same(text, p):
    word = Word(spell(text, p))
    twice = word.letters * 2
    assert word.rotations() == tuple(k for k in range(len(word)) if twice[k : k + len(word)] == word.letters)


@pytest.mark.parametrize(
    ("text", "canonical", "name", "alias"),
    [
        ("LR", "LR", "1:1", "1:1"),
        ("RL/T", "LR", "1:1", "1:1"),
        ("RLL", "LLR", "2:1", "2:1"),
        ("LR/3T", "LR/3T", "1:1/3T", "1:1/3T"),
        ("RLRL/2T", "LRLR/2T", "2:2/2T", "1:1/2T"),
        ("LRLRLRLR/4T", "LRLRLRLR/4T", "4:4/4T", "1:1/4T"),
        ("LRLLRLLRLR/4T", "LLRLLRLRLR/4T", "6:4/4T", "6:4/4T"),
        ("LLRLRLLRLR/4T", "LLRLRLLRLR/4T", "6:4/4T", "3:2/4T"),
    ],
)
def test_names(text, canonical, name, alias):
    word = Word(text)
    assert (str(word), word.name, word.alias) == (canonical, name, alias)


several = st.lists(st.sampled_from(["L1", "R1", "L2", "R2", "L3", "R3"]), min_size=1, max_size=10)


@given(several, periods, st.integers(0, 20))
def test_words_of_several_balls_rotate_by_whole_impacts(impacts, p, k):
    k %= len(impacts)
    word = Word(spell("".join(impacts), p))
    assert Word(spell("".join(impacts[k:] + impacts[:k]), p)) == word == Word(str(word)) == eval(repr(word))
    assert len(word) == len(impacts)
    assert sorted(zip(word.sides, word.balls, strict=True)) == sorted(
        (1 if each[0] == "L" else -1, int(each[1])) for each in impacts
    )
    assert word.mirror.mirror == word
    assert (word.n, word.m) == (word.mirror.m, word.mirror.n)
    if word.symmetric:
        assert word.mirror == word


@given(several, periods, st.permutations([1, 2, 3]))
def test_equal_balls_have_one_word_whatever_they_are_called(impacts, p, order):
    text = "".join(impacts)
    other = "".join(each[0] + str(order[int(each[1]) - 1]) for each in impacts)
    alike = [(1, 2, 3)]
    one, names = Word(spell(text, p)).relabelled(alike)
    assert Word(spell(other, p)).relabelled(alike)[0] == one
    assert "".join(each[0] + str(names[int(each[1:])]) for each in impacts) in one.letters * 2
    every = [
        Word(spell("".join(each[0] + str(new[int(each[1:]) - 1]) for each in impacts), p))
        for new in itertools.permutations([1, 2, 3])
    ]
    assert one == min(every, key=lambda word: word.letters)


def test_equal_balls_are_renamed_at_once_however_many():
    word = Word("".join(f"{side}{ball}" for side in "LR" for ball in (8, 3, 5, 1, 7, 2, 6, 4)))
    assert str(word.relabelled([range(1, 9)])[0]) == "L1L2L3L4L5L6L7L8R1R2R3R4R5R6R7R8"


def test_roles_change_only_among_equal_balls():
    word = Word("L1L2R2R1L2L1R1R2/2T")
    assert (word.shifted([(1, 2)]), word.shifted([]), Word("L1R1L1R1/2T").shifted([(1, 2)])) == ({1: 2, 2: 1}, {}, {})


@pytest.mark.parametrize(
    ("text", "canonical", "name", "symmetric"),
    [
        # systems-check-values.md, (a): a1, a3, a5, a7
        ("L1L2R2R1L2L1R1R2/2T", "L1L2R2R1L2L1R1R2/2T", "2:2|2:2/2T", False),
        ("L1L2R1R2", "L1L2R1R2", "1:1|1:1", True),
        ("L2L1R2R1", "L1R2R1L2", "1:1|1:1", True),
        ("L1L2L3R1R2R3", "L1L2L3R1R2R3", "1:1|1:1|1:1", True),
        ("R3L3", "L3R3", "0:0|0:0|1:1", True),
        ("R1L1L2L2", "L1L2L2R1", "1:1|2:0", False),
    ],
)
def test_names_of_several_balls(text, canonical, name, symmetric):
    word = Word(text)
    assert (str(word), word.name, word.symmetric) == (canonical, name, symmetric)


BAD = ["", "lr", "LXR", "LR/", "LR/0T", "LR/2", "LR/-1T", "LR\n", " LR", "2:1", "L1R", "LR2", "L0R0", "L12R1", 3, None]


@pytest.mark.parametrize("text", BAD)
def test_bad_words_are_refused_in_one_line(text):
    with pytest.raises(ParameterError, match="is not a word") as caught:
        Word(text)
    assert "\n" not in str(caught.value)
    assert "LRLR/2T" in str(caught.value)


def test_the_type_alone_does_not_tell_the_order():
    with pytest.raises(ParameterError, match="order of the impacts"):
        Word("2:2/2T")
    with pytest.raises(ParameterError, match="is not a word: write"):
        Word("0:0/0T")


@pytest.mark.parametrize(
    ("text", "canonical", "name", "sticks", "symmetric", "mirror"),
    [
        ("RL*", "L*R", "1:1", (True, False), False, "LR*"),
        ("R*L*/3T", "L*R*/3T", "1:1/3T", (True, True), True, "L*R*/3T"),
        ("RLLR*", "LLR*R", "2:2", (False, False, True, False), False, "L*LRR"),
    ],
)
def test_a_star_is_a_complete_chatter(text, canonical, name, sticks, symmetric, mirror):
    word = Word(text)
    assert (str(word), word.name, word.sticks, word.symmetric) == (canonical, name, sticks, symmetric)
    assert word.sticking
    assert str(word.mirror) == mirror
    assert not Word("LLR").sticking


@pytest.mark.parametrize("text", ["LL*R", "L*RL", "R*LR"])
def test_an_impact_of_a_chatter_is_not_written_apart(text):
    with pytest.raises(ParameterError, match="part of that chatter"):
        Word(text)


def test_equal_balls_keep_their_stars():
    assert str(Word("L2*L1R2R1").relabelled([(1, 2)])[0]) == "L1*L2R1R2"
    assert (Word("L1*R2").sticks, Word("L1*R2").balls) == ((True, False), (1, 2))


def test_a_word_of_a_run_may_be_longer_than_one_of_which_orbits_are_searched():
    long = Word("LR" * 150)
    assert len(long) == 300
    assert Word(str(long)) == long
    with pytest.raises(ParameterError, match="allowed are 200 impacts over 200T"):
        of_moderate_length(long)
    with pytest.raises(ParameterError, match="allowed are 5000 impacts"):
        Word("L" * 5001)
