"""Cells over part of an image: fine enough, whole in every pixel, and in strips that leave none out."""

import pytest

from seaglint.objects.drawing.eye import CELLS_ACROSS, FEWEST_CELLS, MOST_CELLS, grid_over, strips


@pytest.mark.parametrize("box", [(3.2, 3.9, 7.1, 7.15), (-2.7, 41.3, -0.2, 300.9), (5.0, 6.0, 2.0, 2.0), (10.25, 22.25, 3.5, 4.5)])
def test_cells_cover_the_box_and_whole_pixels(box):
    grid = grid_over(box)
    for way, (low, high) in enumerate((box[:2], box[2:])):
        n, begin, size = grid.cells[way], grid.begin[way], grid.size[way]
        assert begin / n <= low < (begin + 1) / n
        assert size >= 1
        assert high <= (begin + size) / n < high + (1 if size > 1 else 2) / n
        assert grid.first[way] <= low < grid.first[way] + 1
        assert grid.first[way] + grid.pixels[way] - 1 < (begin + size) / n <= grid.first[way] + grid.pixels[way]
        assert n >= FEWEST_CELLS
        if high > low:
            across = n * (high - low)
            assert CELLS_ACROSS <= across < CELLS_ACROSS + (high - low) or n == FEWEST_CELLS


def test_strips_hold_every_cell_once():
    grid = grid_over((-3.3, 900.4, 5.6, 400.2))
    parts = strips(grid)
    assert len(parts) > 1
    assert strips(parts[0]) == [parts[0]]
    end = grid.begin[1]
    for part in parts:
        assert (part.begin[1], part.begin[0]) == (end, grid.begin[0])
        assert part.size[0] == grid.size[0]
        assert part.size[0] * part.size[1] <= MOST_CELLS
        assert part.cells == grid.cells
        assert part.first[0] == grid.first[0]
        assert part.first[1] * grid.cells[1] <= part.begin[1] < (part.first[1] + 1) * grid.cells[1]
        last = part.begin[1] + part.size[1]
        assert (part.first[1] + part.pixels[1] - 1) * grid.cells[1] < last <= (part.first[1] + part.pixels[1]) * grid.cells[1]
        end = last
    assert end == grid.begin[1] + grid.size[1]
    # Whole rows of pixels, as many as the cells allow.
    assert parts[0].size[0] * (parts[1].size[1] + grid.cells[1]) > MOST_CELLS
