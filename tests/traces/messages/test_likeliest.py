import pytest

from skolem.traces.messages.likeliest import likeliest


def test_the_highest_share_wins() -> None:
    assert likeliest({"bottle": 0.13, "can": 0.87}) == "can"
    assert likeliest({"can": -0.1, "bottle": -2.0}) == "can"


@pytest.mark.parametrize("names", [("can", "bottle", "box"), ("box", "can", "bottle")])
def test_of_equal_shares_the_first_by_name_wins_in_whatever_order_they_come(names: tuple[str, ...]) -> None:
    assert likeliest(dict.fromkeys(names, 0.5)) == "bottle"
