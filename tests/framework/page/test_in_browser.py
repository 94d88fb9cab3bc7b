"""The page in a real browser: what it shows at each instant, and that everything can be reached."""

import random
from dataclasses import replace

import pytest

from momantu_bt.engine.role import Role
from momantu_bt.page import write_page
from momantu_bt.page.data import page_data
from tests.framework.page.browser import find_browser, started

STATUSES = "[...document.querySelectorAll('#tree .row')].map((row) => row.dataset.status)"
TICK = "Number(document.documentElement.dataset.tick)"
BOARD = """Object.fromEntries([...document.querySelectorAll('#board tr')].map((row) =>
  [row.querySelector('th').textContent, row.querySelector('.value').textContent]))"""
BY_NODE = """Object.fromEntries([...document.querySelectorAll('[data-node]')].map((item) =>
  [item.dataset.node, item.firstChild.dataset.status]))"""
STATES = ("IDLE", "RUNNING", "SUCCESS", "FAILURE")
NAMES = ("idle", "running", "success", "failure", "skipped")


@pytest.fixture(scope="module")
def browser():
    command = find_browser()
    if command is None:
        pytest.skip("no Chromium: set MOMANTU_BROWSER, or let `make test` bring one")
    with started(command) as browser:
        yield browser


@pytest.fixture(scope="module")
def page(recording, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "run.html"
    write_page(recording(), path)
    return path


@pytest.fixture
def shown(browser, page):
    browser.open(page)
    yield browser
    assert browser.complaints == []


def texts(browser, selector):
    return browser.js(f"[...document.querySelectorAll({selector!r})].map((e) => e.textContent)")


def box(browser, selector):
    """Left, top, width and height of the first such element."""
    sides = "({left, top, width, height}) => [left, top, width, height]"
    return browser.js(f"({sides})(document.querySelector({selector!r}).getBoundingClientRect())")


def at(browser, time):
    browser.js(f"location.hash = '#t={time}'")
    browser.drawn()


def test_it_opens_at_the_end_and_says_how_that_was(shown):
    assert shown.js("document.title") == "bring"
    assert shown.js(TICK) == 99
    assert texts(shown, "#head .outcome") == ["FAILURE"]
    assert shown.js(STATUSES) == ["failure", "success", "success", "failure", "failure", "success"]
    assert texts(shown, ".chain .node") == ["Bring", "recover", "pick"]


def test_an_address_names_an_instant(shown):
    at(shown, 1.5)
    assert shown.js(TICK) == 30
    assert shown.js(STATUSES) == ["running", "running", "running", "idle", "idle", "idle"]
    assert texts(shown, "#tree .row[data-status=running] .note") == ["", "", "follow"]
    assert shown.js(BOARD)["found"] == "{x: 1.235, y: 0.5, yaw: 0}"
    assert texts(shown, "#board .fresh th") == ["found", "n"]
    assert texts(shown, "#camera .caption") == ["head at 1.00 s, 0.50 s ago"]
    assert texts(shown, "#floor .seen text") == ["can"]
    assert texts(shown, "#source .deepest") == ["    - GoTo: {surface: table_a}"]
    at(shown, 4.5)
    assert texts(shown, "#floor .caption")[0].endswith("holds can")


def test_keys_go_by_ticks_changes_failures_and_seconds(shown):
    presses = [
        ("Home", 0),
        ("ArrowRight", 1),
        ("n", 4),
        ("n", 40),
        ("p", 4),
        ("f", 60),
        ("f", 99),
        ("F", 60),
        ("ArrowLeft", 59),
        ("End", 99),
    ]
    for key, tick in presses:
        shown.press(key)
        assert shown.js(TICK) == tick, key
    shown.press("ArrowLeft", shift=True)
    assert shown.js(TICK) == 79


def test_the_timeline_can_be_dragged(shown):
    left, top, width, _ = box(shown, ".bars")

    def above(tick):
        return left + (tick + 0.5) / 99 * width, top + 30

    shown.mouse("mousePressed", *above(24))
    assert shown.js(TICK) == 24
    for tick in (50, 75, 9):
        shown.mouse("mouseMoved", *above(tick))
        assert shown.js(TICK) == tick
    shown.mouse("mouseReleased", *above(9))
    shown.mouse("mouseMoved", *above(80))
    assert shown.js(TICK) == 9


def test_hovering_over_a_bar_tells_what_it_was(shown):
    left, top, _, _ = box(shown, ".bar[data-status=failure]")
    shown.call("Input.dispatchMouseEvent", type="mouseMoved", x=left + 5, y=top + 5)
    shown.until("!document.getElementById('tip').hidden")
    assert "failed: GRASP_MISSED, the fingers closed on nothing" in texts(shown, "#tip")[0]


def test_it_plays_and_stops(shown):
    shown.press("Home")
    shown.press(" ")
    shown.until(f"{TICK} > 2")
    shown.press(" ")
    tick = shown.js(TICK)
    shown.drawn()
    assert shown.js(TICK) == tick < 99
    shown.js("document.querySelector('.controls select').value = 20")
    shown.js("document.querySelector('.controls select').dispatchEvent(new Event('change'))")
    shown.press(" ")
    shown.until(f"{TICK} === 99")
    assert texts(shown, ".play") == ["▶"]


def test_the_tree_is_walked_with_keys(shown):
    focused = "document.activeElement.dataset.node"
    shown.js("document.querySelector('#tree [tabindex=\"0\"]').focus()")
    walk = [
        ("ArrowDown", "1"),
        ("ArrowRight", "1"),
        ("ArrowRight", "2"),
        ("ArrowLeft", "1"),
        ("End", "5"),
        ("ArrowUp", "4"),
        ("ArrowLeft", "3"),
        ("Home", "0"),
    ]
    for key, node in walk:
        shown.press(key)
        assert shown.js(focused) == node, key
    assert shown.js("document.querySelector('[data-node=\"1\"]').ariaExpanded") == "true"
    assert texts(shown, "#tree [aria-selected=true] > .row .label") == ["Bring"]
    assert shown.js(TICK) == 99


def test_a_node_of_a_chain_is_shown_in_the_tree_and_in_the_file(shown):
    shown.js("document.querySelectorAll('.chain button')[2].click()")
    assert texts(shown, "#tree [aria-selected=true] > .row .label") == ["pick object $found"]
    assert texts(shown, "#source [data-chosen]") == ["        try: {pick: {object: $found}}"]


def test_following_opens_what_runs_and_folds_the_rest(shown):
    visible = "[...document.querySelectorAll('#tree .row')].map((row) => row.offsetParent !== null)"
    at(shown, 1.0)
    assert shown.js(visible) == [True, True, True, True, False, False]
    at(shown, 3.5)
    assert shown.js(visible) == [True, True, False, True, True, True]
    shown.js("[...document.querySelectorAll('#tree button')][0].click()")
    at(shown, 1.0)
    assert shown.js(visible) == [True] * 6


@pytest.mark.parametrize("width", [360, 700, 900, 1400])
@pytest.mark.parametrize("dark", [False, True])
def test_it_fits_every_width_and_nothing_jumps(browser, page, width, dark):
    browser.open(page, width=width, height=900, dark=dark)
    assert browser.js("document.documentElement.scrollWidth <= window.innerWidth")
    boxes = """JSON.stringify([...document.querySelectorAll('.panel, #timeline, .bars')].map((e) =>
      (({x, y, width, height}) => [x, y, width, height])(e.getBoundingClientRect())))"""
    places = set()
    for time in (0, 0.3, 1.5, 3.0, 4.95):
        at(browser, time)
        places.add(browser.js(boxes))
    assert len(places) == 1
    light = sum(
        browser.js(
            "getComputedStyle(document.documentElement).backgroundColor.match(/\\d+/g).map(Number)"
        )
    )
    assert (light < 200) == dark
    assert browser.complaints == []


def test_jumping_about_a_long_run_shows_what_going_through_it_would(browser, recording, tmp_path):
    drawn = random.Random(5)
    nodes = [("n", "Sequence", 0, None, "root", 1)]
    for index in range(1, 60):
        parent = drawn.randrange(index)
        nodes.append((f"n{index}", "Sequence", nodes[parent][2] + 1, parent, f"n {index}", 1))
    story = {
        tick: [
            (drawn.randrange(60), drawn.choice(STATES), "", None) for _ in range(drawn.randrange(4))
        ]
        for tick in range(1500)
    }
    run = recording(nodes=nodes, story=story, ticks=1500, report=None)
    write_page(run, tmp_path / "long.html")
    browser.open(tmp_path / "long.html")
    changes = page_data(run)["changes"]
    rows = list(zip(changes["tick"], changes["node"], changes["status"], strict=True))
    for tick in drawn.sample(range(1500), 25):
        wanted = ["idle"] * 60
        for _, node, status in (row for row in rows if row[0] <= tick):
            wanted[node] = NAMES[status]
        at(browser, 0.05 * tick)
        found = browser.js(BY_NODE)
        assert [found[str(node)] for node in range(60)] == wanted, tick
    assert browser.complaints == []


def test_frames_have_no_row_and_labels_follow_the_run(browser, recording, tmp_path):
    run = recording()
    roles = {0: Role.TREE, 3: Role.STEPS}
    nodes = tuple(replace(n, role=roles.get(n.index, n.role)) for n in run.nodes)
    newer = replace(run.ticks[40], labels=((4, "pick object can_1"),))
    ticks = (*run.ticks[:40], newer, *run.ticks[41:])
    write_page(replace(run, nodes=nodes, ticks=ticks), tmp_path / "frames.html")
    browser.open(tmp_path / "frames.html", at="#t=1")
    rows = ["Bring", "GoTo surface table_a", "navigate in_front_of table_a"]
    assert texts(browser, "#tree .label") == [*rows, "pick object $found", "reset_pose ready"]
    assert browser.js("document.querySelectorAll('#tree > .body > ul > li > ul > li').length") == 3
    at(browser, 2.5)
    assert texts(browser, "#tree .label")[3] == "pick object can_1"
    assert texts(browser, ".doing") == ["tick 51  pick object can_1, reach"]
    assert browser.complaints == []


def test_names_stay_texts(browser, recording, tmp_path):
    evil = "</script><img src=x onerror=\"document.title='caught'\"><b>"
    nodes = [(evil, evil, 0, None, evil, 1), (evil, evil, 1, 0, evil, 1)]
    run = recording(nodes=nodes, story={}, about={"tree": evil}, files={evil: evil})
    write_page(run, tmp_path / "evil.html")
    browser.open(tmp_path / "evil.html")
    assert texts(browser, "#tree .label") == [evil] * 2
    assert texts(browser, "#source li") == [evil]
    assert browser.js("document.querySelectorAll('img[onerror], b, script').length") == 2
    assert browser.js("document.title") != "caught"
    assert browser.complaints == []


def test_a_run_without_anything_opens(browser, recording, tmp_path):
    run = recording(nodes=(), ticks=0, story={}, files={}, report=None, raw={}, complete=False)
    write_page(run, tmp_path / "empty.html")
    browser.open(tmp_path / "empty.html")
    assert texts(browser, "#head .outcome") == ["cut off"]
    assert texts(browser, ".panel h2") == ["Tree", "Blackboard", "Failures (0)", "File"]
    for key in ("ArrowRight", " ", "f", "n", "End", "Home"):
        browser.press(key)
    assert browser.complaints == []
