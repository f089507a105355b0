import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.testing import assert_array_equal

from spheremesh.viewer.page.container import pack_arrays, unpack_arrays

SHAPES = arrays.array_shapes(min_dims=1, max_dims=3, min_side=0, max_side=5)
INTEGERS = arrays.arrays(np.int64, SHAPES, elements=st.integers(-(1 << 29), 1 << 29))
FLOATS = arrays.arrays(np.float32, SHAPES, elements=st.floats(-1e9, 1e9, width=32))
BYTES = arrays.arrays(np.uint8, SHAPES)


@given(st.dictionaries(st.text(), st.one_of(INTEGERS, FLOATS, BYTES), max_size=4))
def test_arrays_come_back_as_they_were(given_arrays: dict[str, np.ndarray]) -> None:
    head, found = unpack_arrays(pack_arrays({"title": "Dächer </script>"}, given_arrays))
    assert head == {"title": "Dächer </script>"}
    assert list(found) == list(given_arrays)
    for name, array in given_arrays.items():
        assert found[name].shape == array.shape
        assert_array_equal(found[name], array)
