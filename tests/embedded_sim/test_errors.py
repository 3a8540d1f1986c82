import pickle

from hypothesis import given
from hypothesis import strategies as st

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.errors import LONGEST, nearest, quoted, shown

anything = st.text(st.characters(), max_size=300) | st.binary(max_size=300).map(
    lambda raw: raw.decode("utf-8", "surrogateescape")
)


@given(anything)
def test_what_is_shown_is_one_short_line_without_control_characters(text):
    assert shown(text).isprintable()
    assert len(shown(text)) <= LONGEST
    assert shown(shown(text)) == shown(text)


def test_printable_text_is_shown_as_it_is():
    assert shown("Größe 3 😀 \\n") == "Größe 3 😀 \\n"


def test_what_is_cut_ends_with_an_ellipsis():
    assert shown("x" * 1000) == "x" * (LONGEST - 1) + "…"


def test_escape_codes_and_lines_become_their_escapes():
    assert shown("a\x1b[31m\nb\udcff\u202e") == "a\\x1b[31m\\nb\\udcff\\u202e"


def test_a_number_too_large_for_text_is_shown_as_such():
    assert shown(1 << 20_000) == quoted(1 << 20_000) == "a int too large to print"


@given(anything, anything, anything)
def test_a_refusal_keeps_its_fields_on_its_way_from_a_worker(field, got, expected):
    error = InputError(field, got, expected)
    back = pickle.loads(pickle.dumps(error))
    assert isinstance(back, InputError)
    assert (back.field, back.got, back.expected) == (error.field, error.got, error.expected)
    assert str(back) == str(error)
    assert str(error).isprintable()


def test_the_nearest_of_many_names_is_still_told():
    names = [f"column_{k:04d}" for k in range(1000)]
    said = str(InputError("x", "y", nearest("column_0999x", names)))
    assert "did you mean column_0999?" in said
    assert len(said) < 1300
