"""C4: physical operations have an executable procedure, inference rules have none."""

from kit.papers import EXAMPLE_GOAL, NINE, example, posed, rehearsed

from skolem.reasoner.terms import parse_term

OPERATORS = {"look_at", "look_at_region", "move", "pick", "place", "weigh"}
AXIOMS = {"examine_obj", "find_obj", "infer", "remove_obst", "split"}
FLUENTS = (
    f"b(den(e1,o2),{NINE})",
    f"b(den(e1,sk(var(o))),{NINE})",
    "b(holds((green,heavy),o2),70241)",
    f"b(supposed(heavy,o2),{NINE})",
    f"b(prop(green,o3),{NINE})",
    "b(type(o2,soda),35120)",
    "bn(colour(o2),any,sd(20,50,50),any,1)",
    "bn(pose(o2),any,sd(8,8,any),any,1)",
    "bn(weight(o2),any,sd(100),any,1)",
    f"b(contents(_reg2_),{NINE})",
    f"b(on(o2,desk),{NINE})",
    "holding(o2)",
    "held(right,o2)",
    "clear(pick(right,o2))",
    "aside(o1,pick(right,o2))",
    "at(look(o2))",
)


def test_every_operator_has_a_primitive_and_no_axiom_has() -> None:
    """ "Physical operations are accompanied by an executable procedure, parameterized by aspects of theta." """
    play = example()
    at = posed(EXAMPLE_GOAL, play.belief, geometry=play.geometry)
    instances = [i for fluent in FLUENTS for i in at.offers.offers(parse_term(fluent))]
    named = {str(i.operation).partition("(")[0]: i.executes for i in instances}
    assert set(named) == OPERATORS | AXIOMS
    assert {name for name, executes in named.items() if executes is not None} == OPERATORS


def test_what_is_carried_out_has_a_command_for_the_robot() -> None:
    """ "An executable procedure." """
    play, _ = rehearsed()
    kinds = {turn.action.command.kind for turn in play.turns if turn.action is not None}
    assert kinds == {"move_base", "look_at", "pick", "place", "weigh"}
