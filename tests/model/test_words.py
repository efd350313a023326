import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vines.errors import ParameterError
from vines.model import Word

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


@pytest.mark.parametrize("text", ["", "lr", "LXR", "LR/", "LR/0T", "LR/2", "LR/-1T", "LR\n", " LR", "2:1", 3, None])
def test_bad_words_are_refused_in_one_line(text):
    with pytest.raises(ParameterError, match="is not a word") as caught:
        Word(text)
    assert "\n" not in str(caught.value)
    assert "LRLR/2T" in str(caught.value)


def test_the_type_alone_does_not_tell_the_order():
    with pytest.raises(ParameterError, match="order of the impacts"):
        Word("2:2/2T")
