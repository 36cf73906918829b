"""A problem as determinised PDDL: every observation has the expected result, at a cost of -ln of its probability.

`DETAILED` is the paper's example, compiled by hand to the robot's belief: every fluent that matters here is one
predicate, read "believed with .9", and every action of the robot one action. `CHOICE` has only the steps that decide
which object is meant: examine, search, put down.
"""

import math
import re
from collections.abc import Iterable, Iterator
from typing import Final

from benchmarks.problems import Problem, support
from skolem.reasoner.terms import nll
from skolem.traces.messages import Limits

_STEP: Final = nll(0.95)  # the step of CHOICE that puts the object down, micro-nats, as the rules price it
_HOPED: Final = 0.1  # P of a property below which the detailed problem does not offer to look for it
# Prices of the detailed problem are in hundredths of nats.
_ACT: Final = 10  # a look for a pose, a pick, a place
_SEARCH: Final = 20  # a look into a region
_PER_METRE: Final = 10  # of a drive

DETAILED = f"""(define (domain detailed)
  (:requirements :strips :typing :action-costs)
  (:types thing site stand - object)
  (:constants desk - site)
  (:predicates (at ?s - stand) (sees ?s - stand ?w - site) (reaches ?s - stand ?w - site)
    (known ?o - thing) (rests ?o - thing ?w - site) (brought ?o - thing ?w - site) (located ?o - thing)
    (kind-known ?o - thing) (colour-known ?o - thing) (weight-known ?o - thing) (meant ?o - thing)
    (kind-hoped ?o - thing) (colour-hoped ?o - thing) (weight-hoped ?o - thing)
    (hand-free) (holding ?o - thing) (free ?o - thing) (before ?o - thing ?next - thing) (room ?w - site)
    (searched ?w - site) (may-hold ?w - site ?o - thing) (achieved))
  (:functions (total-cost) (way ?s ?to) (kind-doubt ?o) (colour-doubt ?o) (weight-doubt ?o) (absence ?w) - number)
  (:action drive :parameters (?from - stand ?to - stand)
    :precondition (at ?from)
    :effect (and (not (at ?from)) (at ?to) (increase (total-cost) (way ?from ?to))))
  (:action look-where :parameters (?o - thing ?w - site ?s - stand)
    :precondition (and (known ?o) (rests ?o ?w) (at ?s) (sees ?s ?w))
    :effect (and (located ?o) (increase (total-cost) {_ACT})))
  (:action look-kind :parameters (?o - thing ?w - site ?s - stand)
    :precondition (and (known ?o) (rests ?o ?w) (at ?s) (sees ?s ?w) (kind-hoped ?o))
    :effect (and (kind-known ?o) (increase (total-cost) (kind-doubt ?o))))
  (:action look-colour :parameters (?o - thing ?w - site ?s - stand)
    :precondition (and (known ?o) (rests ?o ?w) (at ?s) (sees ?s ?w) (colour-hoped ?o))
    :effect (and (colour-known ?o) (increase (total-cost) (colour-doubt ?o))))
  (:action pick :parameters (?o - thing ?next - thing ?w - site ?s - stand)
    :precondition (and (hand-free) (known ?o) (located ?o) (free ?o) (before ?o ?next) (rests ?o ?w) (at ?s)
      (reaches ?s ?w))
    :effect (and (holding ?o) (free ?next) (not (hand-free)) (not (rests ?o ?w)) (not (located ?o))
      (increase (total-cost) {_ACT})))
  (:action weigh :parameters (?o - thing)
    :precondition (and (holding ?o) (weight-hoped ?o))
    :effect (and (weight-known ?o) (increase (total-cost) (weight-doubt ?o))))
  (:action place :parameters (?o - thing ?w - site ?s - stand)
    :precondition (and (holding ?o) (room ?w) (at ?s) (reaches ?s ?w))
    :effect (and (hand-free) (rests ?o ?w) (brought ?o ?w) (located ?o) (not (holding ?o))
      (increase (total-cost) {_ACT})))
  (:action search :parameters (?w - site ?s - stand)
    :precondition (and (at ?s) (sees ?s ?w))
    :effect (and (searched ?w) (increase (total-cost) {_SEARCH})))
  (:action find :parameters (?o - thing ?w - site)
    :precondition (and (searched ?w) (may-hold ?w ?o))
    :effect (and (known ?o) (rests ?o ?w) (located ?o) (kind-known ?o) (colour-known ?o)
      (increase (total-cost) (absence ?w))))
  (:action examine :parameters (?o - thing)
    :precondition (and (known ?o) (kind-known ?o) (colour-known ?o) (weight-known ?o))
    :effect (and (meant ?o) (increase (total-cost) 0)))
  (:action finish :parameters (?o - thing)
    :precondition (and (meant ?o) (brought ?o desk))
    :effect (and (achieved) (increase (total-cost) 0))))
"""

CHOICE = f"""(define (domain choice)
  (:requirements :strips :typing :action-costs)
  (:types thing region - object)
  (:predicates (plausible ?o - thing) (may-hold ?r - region ?o - thing) (meant ?o - thing) (put ?o - thing) (achieved))
  (:functions (total-cost) - number (doubt ?o - thing) - number (absence ?r - region) - number)
  (:action examine :parameters (?o - thing)
    :precondition (plausible ?o)
    :effect (and (meant ?o) (increase (total-cost) (doubt ?o))))
  (:action find :parameters (?o - thing ?r - region)
    :precondition (may-hold ?r ?o)
    :effect (and (meant ?o) (increase (total-cost) (absence ?r))))
  (:action place :parameters (?o - thing)
    :precondition (meant ?o)
    :effect (and (put ?o) (increase (total-cost) {_STEP})))
  (:action finish :parameters (?o - thing)
    :precondition (and (meant ?o) (put ?o))
    :effect (and (achieved) (increase (total-cost) 0))))
"""


def choice(given: Problem) -> str:
    """Return the problem of the domain `CHOICE`, prices in micro-nats."""
    hidden = _hidden(given)
    facts = [f"(plausible {item.name})" for item in given.items if item.meant >= Limits().min_plausible]
    facts += [f"(may-hold {region} {name})" for region, name in hidden.items()]
    facts += [f"(= (doubt {item.name}) {nll(item.meant)})" for item in given.items]
    facts += [f"(= (absence {region}) {nll(p)})" for region, p in given.regions.items()]
    things = _names([*(item.name for item in given.items), *hidden.values()])
    return _problem("choice", f"{things} - thing {_names(given.regions)} - region", facts)


def detailed(given: Problem) -> str:
    """Return the problem of the domain `DETAILED`, prices in hundredths of nats.

    The base may stand at its home or at any site. An object in the way is put aside, which is possible from everywhere;
    otherwise only the desk has room. An object becomes free when the one before it is picked.
    """
    stands = {"home": given.home, "by-desk": given.places["desk"]}
    stands |= {f"by-{table}": given.places[table] for table in given.tables}
    stands |= {f"by-{region}": given.places[support(region)] for region in given.regions}
    facts = ["(at home)", "(hand-free)", "(room desk)", "(room aside)"]
    facts += [f"(sees {stand} {stand[3:]}) (reaches {stand} {stand[3:]})" for stand in stands if stand != "home"]
    facts += [f"(reaches {stand} aside)" for stand in stands]
    facts += [*_known(given), *_hoped_for(given), *_ways(stands)]
    things = _names([*(item.name for item in given.items), *_hidden(given).values(), "nothing"])
    sites = _names([*given.tables, *given.regions, "aside"])
    return _problem("detailed", f"{things} - thing {sites} - site {_names(stands)} - stand", facts)


def without_costs(text: str) -> str:
    """Return a domain or problem of this module without costs, for a planner that only counts steps."""
    kept = [line for line in text.splitlines() if not line.lstrip().startswith(("(:functions", "(:metric", "(= "))]
    out = "\n".join(kept).replace(" :action-costs", "")
    return re.sub(r" \(increase \(total-cost\) (\d+|\([^()]*\))\)", "", out)


def _hidden(given: Problem) -> dict[str, str]:
    """Return the name of the possible object in each region, by region."""
    return {region: f"in{region}" for region in given.regions}


def _known(given: Problem) -> Iterator[str]:
    """Yield the facts about the known objects."""
    behind = {item.before[-1]: item.name for item in given.items if item.before}
    for item in given.items:
        yield f"(known {item.name}) (rests {item.name} {item.table})"
        yield f"(before {item.name} {behind.get(item.name, 'nothing')})"
        if not item.before:
            yield f"(free {item.name})"
        shares = {"kind": item.can, "colour": item.green, "weight": item.heavy}
        yield from (f"({name}-hoped {item.name})" for name, p in shares.items() if p >= _HOPED)
        yield from (f"(= ({name}-doubt {item.name}) {_price(p)})" for name, p in shares.items())


def _hoped_for(given: Problem) -> Iterator[str]:
    """Yield the facts about regions: the price of a search is -ln of the probability of a heavy green can there."""
    for region, name in _hidden(given).items():
        yield f"(may-hold {region} {name}) (free {name}) (before {name} nothing) (weight-hoped {name})"
        yield f"(= (absence {region}) {_price(given.regions[region])})"
    for name in [*_hidden(given).values(), "nothing"]:
        yield from (f"(= ({what}-doubt {name}) 0)" for what in ("kind", "colour", "weight"))


def _ways(stands: dict[str, tuple[float, float]]) -> Iterator[str]:
    for start, here in stands.items():
        for end, there in stands.items():
            yield f"(= (way {start} {end}) {max(1, round(_PER_METRE * math.dist(here, there)))})"


def _price(p: float) -> int:
    """Return -ln p in hundredths of nats; a p below .001 counts as .001."""
    return round(-100.0 * math.log(max(p, 1e-3)))


def _problem(domain: str, objects: str, facts: list[str]) -> str:
    init = "\n  ".join([*facts, "(= (total-cost) 0)"])
    return (
        f"(define (problem example) (:domain {domain})\n (:objects {objects})\n (:init\n  {init}\n )\n"
        " (:goal (achieved))\n (:metric minimize (total-cost))\n)\n"
    )


def _names(names: Iterable[str]) -> str:
    return " ".join(names)
