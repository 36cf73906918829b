"""A problem as PDDL, determinised: an observation shows what is hoped for, at -ln of its probability in micro-nats.

`detailed` has every action of the robot; `choice` only what decides which object is meant: examine, search, put down.
"""

import re
from collections.abc import Iterable

from benchmarks.problems import Problem, support
from skolem.reasoner.terms import nll

_STEP = nll(0.95)  # a look, a pick, a place
_DRIVE = nll(0.97)
_IMPLAUSIBLE = 1e-3  # P of being meant: below, the reasoner does not consider an object either

DETAILED = f"""(define (domain detailed)
  (:requirements :strips :typing :action-costs)
  (:types thing place region - object)
  (:constants desk - place)
  (:predicates (at ?p - place) (hand-free) (holding ?o - thing) (stands ?o - thing ?p - place) (free ?o - thing)
    (before ?o - thing ?next - thing) (located ?o - thing) (looked ?o - thing) (weighed ?o - thing)
    (plausible ?o - thing) (meant ?o - thing) (lies ?r - region ?p - place) (seen ?r - region)
    (may-hold ?r - region ?o - thing) (done))
  (:functions (total-cost) - number (doubt ?o - thing) - number (absence ?r - region) - number)
  (:action drive :parameters (?from - place ?to - place)
    :precondition (at ?from)
    :effect (and (not (at ?from)) (at ?to) (increase (total-cost) {_DRIVE})))
  (:action look :parameters (?o - thing ?p - place)
    :precondition (and (at ?p) (stands ?o ?p))
    :effect (and (located ?o) (looked ?o) (increase (total-cost) {_STEP})))
  (:action pick :parameters (?o - thing ?p - place ?next - thing)
    :precondition (and (at ?p) (stands ?o ?p) (located ?o) (free ?o) (hand-free) (before ?o ?next))
    :effect (and (holding ?o) (free ?next) (not (hand-free)) (not (stands ?o ?p)) (increase (total-cost) {_STEP})))
  (:action place :parameters (?o - thing ?p - place)
    :precondition (and (at ?p) (holding ?o))
    :effect (and (hand-free) (stands ?o ?p) (not (holding ?o)) (increase (total-cost) {_STEP})))
  (:action weigh :parameters (?o - thing)
    :precondition (holding ?o)
    :effect (and (weighed ?o) (increase (total-cost) 0)))
  (:action look-region :parameters (?r - region ?p - place)
    :precondition (and (at ?p) (lies ?r ?p))
    :effect (and (seen ?r) (increase (total-cost) {_STEP})))
  (:action examine :parameters (?o - thing)
    :precondition (and (plausible ?o) (looked ?o) (weighed ?o))
    :effect (and (meant ?o) (increase (total-cost) (doubt ?o))))
  (:action find :parameters (?o - thing ?r - region ?p - place)
    :precondition (and (seen ?r) (may-hold ?r ?o) (lies ?r ?p))
    :effect (and (stands ?o ?p) (free ?o) (located ?o) (looked ?o) (plausible ?o) (increase (total-cost) (absence ?r))))
  (:action finish :parameters (?o - thing)
    :precondition (and (meant ?o) (stands ?o desk))
    :effect (and (done) (increase (total-cost) 0))))
"""

CHOICE = f"""(define (domain choice)
  (:requirements :strips :typing :action-costs)
  (:types thing region - object)
  (:predicates (plausible ?o - thing) (may-hold ?r - region ?o - thing) (meant ?o - thing) (put ?o - thing) (done))
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
    :effect (and (done) (increase (total-cost) 0))))
"""


def choice(given: Problem) -> str:
    """Return the problem of the domain `CHOICE`."""
    hidden = {f"in{region}": region for region in given.regions}
    facts = [f"(plausible {item.name})" for item in given.items if item.meant >= _IMPLAUSIBLE]
    facts += [f"(may-hold {region} {name})" for name, region in hidden.items()]
    objects = f"{_names([item.name for item in given.items] + list(hidden))} - thing {_names(given.regions)} - region"
    return _problem("choice", objects, [*facts, *_prices(given, list(hidden))])


def detailed(given: Problem) -> str:
    """Return the problem of the domain `DETAILED`."""
    hidden = {f"in{region}": region for region in given.regions}
    facts = ["(at desk)", "(hand-free)"]
    behind = {item.before[-1]: item.name for item in given.items if item.before}
    for item in given.items:
        facts += [f"(stands {item.name} {item.table})", f"(before {item.name} {behind.get(item.name, 'nothing')})"]
        facts += [] if item.before else [f"(free {item.name})"]
        facts += [f"(plausible {item.name})"] if item.meant >= _IMPLAUSIBLE else []
    for name, region in hidden.items():
        facts += [f"(may-hold {region} {name})", f"(lies {region} {support(region)})", f"(before {name} nothing)"]
    things = _names([item.name for item in given.items] + list(hidden))
    places = _names(name for name in given.places if name != "desk")
    objects = f"{things} nothing - thing {places} - place {_names(given.regions)} - region"
    return _problem("detailed", objects, [*facts, *_prices(given, [*hidden, "nothing"])])


def without_costs(text: str) -> str:
    """Return a domain or problem of this module for a planner that counts steps only."""
    kept = [line for line in text.splitlines() if not line.lstrip().startswith(("(:functions", "(:metric", "(= "))]
    out = "\n".join(kept).replace(" :action-costs", "")
    return re.sub(r" \(increase \(total-cost\) (\d+|\([^()]*\))\)", "", out)


def _prices(given: Problem, hidden: list[str]) -> list[str]:
    prices = [f"(= (doubt {item.name}) {nll(item.meant)})" for item in given.items]
    prices += [f"(= (doubt {name}) 0)" for name in hidden]  # paid when it is found
    return prices + [f"(= (absence {region}) {nll(p)})" for region, p in given.regions.items()]


def _problem(domain: str, objects: str, facts: list[str]) -> str:
    init = "\n  ".join([*facts, "(= (total-cost) 0)"])
    return (
        f"(define (problem example) (:domain {domain})\n (:objects {objects})\n (:init\n  {init}\n )\n"
        " (:goal (done))\n (:metric minimize (total-cost))\n)\n"
    )


def _names(names: Iterable[str]) -> str:
    return " ".join(names)
