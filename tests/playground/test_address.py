"""The state in the address: round trips, and addresses that are wrong or hostile."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from qtab.playground import definitions
from support.playground import Playground

pytestmark = pytest.mark.browser

FRAGMENT = "() => { history.replaceState(null, '', location.pathname); return playground.fragment(playground.store); }"


@pytest.mark.parametrize(
    "fragment",
    [
        "#env=MountainCar-v0&example=1",
        "#env=MountainCar-v0&discretizer=tiles&tilings=4&tiles=5,7&algorithm=true_online_sarsa_lambda&episodes=30&learning_rate=1.5",
        "#env=CartPole-v1&bins=1,2,3,4&episodes=30&seed=7&seeds=16",
        "#env=MountainCar-v0&discretizer=fourier&order=7&coupled=false&learning_rate=0.004&episodes=30",
        "#env=grid&layout=S..W/.WG./....&step_reward=-0.5&goal_reward=3&rewards=2,1,-4/0,1,2.5&wind=0,1,0,0&episodes=20",
        "#env=FrozenLake-v1&exploration=softmax&temperature=0.5&initial_q=-0.25,0.75&episodes=20",
    ],
)
def test_an_address_restores_the_state(playground: Playground, fragment: str) -> None:
    playground.open(fragment)
    state, result = playground.state(), playground.result()
    again = playground.page.evaluate(FRAGMENT)
    playground.open(f"#{again}")
    assert playground.state() == state
    assert playground.result() == result
    for part in fragment[1:].split("&"):
        name, value = part.split("=")
        if name in state["settings"]:
            kept = state["settings"][name]
            numbers = kept if isinstance(kept, list) else [kept]
            assert ",".join(map(str, numbers)).replace("False", "false") == value


def test_the_address_follows_the_settings(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1")
    playground.type_number("learning_rate", "0.25")
    playground.page.wait_for_function("() => location.hash.includes('learning_rate=0.25')")


def test_an_address_without_seeds_has_the_first_one_alone(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&seed=7&seeds=16")
    playground.page.evaluate("() => { location.hash = '#env=CliffWalking-v1'; }")
    playground.page.wait_for_function("() => playground.store.state.seed === 0")
    assert playground.settled().result()["seeds"] == [0]


def test_an_address_without_an_environment_has_the_first_one(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&episodes=20")
    playground.page.evaluate("() => playground.restore(playground.store, 'episodes=30')")
    assert playground.settled().state()["environment"] == "MountainCar-v0"
    assert playground.state()["settings"]["episodes"] == 30


@pytest.mark.parametrize(
    ("fragment", "settings", "note"),
    [
        ("#env=MountainCar-v0&scale=10", {"scale": [10, 10]}, ""),
        ("#env=CartPole-v1&discretizer=bins&low=-1&high=1&bins=3", {"low": [-1] * 4, "high": [1] * 4, "bins": 3}, ""),
        ("#env=MountainCar-v0&scale=10,20,30", {"scale": [10, 100]}, "scale"),
        ("#env=MountainCar-v0&learning_rate=1.5", {"learning_rate": 1}, "learning_rate"),
        ("#env=MountainCar-v0&epsilon=0.3&min_epsilon=0.4", {"min_epsilon": 0.3}, "min_epsilon"),
        (
            "#env=MountainCar-v0&epsilon_warm_up=500&episodes=30",
            {"epsilon_warm_up": 29, "episodes": 30},
            "epsilon_warm_up",
        ),
        (
            "#env=MountainCar-v0&discretizer=bins&low=1,1&high=0,0",
            {"low": [-1.2000000476837158, -0.07000000029802322]},
            "low",
        ),
        ("#env=MountainCar-v0&algorithm=dyna_q&discretizer=tiles", {"algorithm": "q_learning"}, "algorithm"),
        ("#env=MountainCar-v0&algorithm=sarsa&n_steps=3", {"algorithm": "sarsa"}, "n_steps"),
        ("#env=MountainCar-v0&scael=10", {}, "scael"),
        (
            "#env=MountainCar-v0&discretizer=fourier",
            {"order": 3, "coupled": True, "learning_rate": 0.001, "initial_q": 0, "terminal_update": "target"},
            "",
        ),
        ("#env=MountainCar-v0&discretizer=fourier&order=16", {"order": 15}, "order"),
        (
            "#env=MountainCar-v0&example=3&discretizer=fourier&order=2",
            {"order": 2, "learning_rate": 0.003, "algorithm": "n_step_sarsa"},
            "",
        ),
        ("#env=MountainCar-v0&example=3&discretizer=bins", {"learning_rate": 0.2, "initial_q": [-1.0, 1.0]}, ""),
        (
            "#env=MountainCar-v0&discretizer=fourier&algorithm=sarsa_lambda&traces=replacing",
            {"algorithm": "sarsa_lambda", "traces": "accumulating", "trace_decay": 0.9},
            "traces",
        ),
        ("#env=Acrobot-v1&discretizer=fourier&order=2&algorithm=sarsa&max_episode_steps=50", {"order": 1}, "order"),
        ("#env=MountainCar-v0&discretizer=fourier&coupled=1", {"coupled": True}, "coupled"),
        (
            "#env=MountainCar-v0&discretizer=fourier&algorithm=dyna_q&learning_rate_schedule=visits",
            {"algorithm": "q_learning", "learning_rate_schedule": "constant"},
            "algorithm, learning_rate_schedule",
        ),
        ("#env=MountainCar-v0&example=2&wnid=1", {"tilings": 32}, "wnid"),
        ("#env=grid&wind=0,1", {}, "wind"),
        ("#env=CliffWalking-v1&layout=S.G", {}, "layout"),
    ],
)
def test_what_does_not_fit_is_cut_or_left_out_and_named(
    playground: Playground, fragment: str, settings: dict[str, object], note: str
) -> None:
    given = "" if "example" in fragment else "&max_episode_steps=30" if "warm_up" in fragment else "&episodes=20"
    playground.open(fragment + given)
    assert settings.items() <= playground.state()["settings"].items()
    assert playground.result()["state"] == "finished"
    problem = playground.page.locator("#problem")
    assert problem.is_visible() == bool(note)
    if note:
        assert f"left out or changed: {note}" in problem.inner_text()


def test_a_table_that_is_too_large_is_refused_in_a_sentence(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1")
    endless = "env=CartPole-v1&episodes=100000&seeds=16"
    playground.page.evaluate("endless => playground.restore(playground.store, endless)", endless)
    playground.page.wait_for_function("() => document.querySelector('#run').disabled")
    wanted = "env=CartPole-v1&discretizer=bins&bins=60,60,60,60&seeds=16&algorithm=dyna_q"
    playground.page.evaluate("wanted => playground.restore(playground.store, wanted)", wanted)
    playground.page.wait_for_function("() => playground.training.state === 'refused'")
    problem = playground.text("problem")
    assert playground.page.locator("#run").is_enabled()
    assert playground.page.locator("#stop").is_disabled()
    assert problem.startswith("16 runs with a table of 12960000 rows and 2 actions would take 18")
    assert problem.endswith("MiB, and the page has 512 MiB for them: choose fewer cells, or fewer seeds")
    playground.page.evaluate("() => playground.restore(playground.store, 'env=CliffWalking-v1')")
    assert playground.settled().result()["state"] == "finished"


def test_examples_and_presets_need_no_cut(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1")
    changed = playground.page.evaluate(
        """() => {
          const { store, EXAMPLES } = playground;
          const { environments } = store.definitions;
          const changed = [];
          for (const [environment, { presets }] of Object.entries(environments)) {
            const ofExample = ({ preset, settings }) => ({ ...presets[preset], ...settings });
            const given = [...Object.values(presets), ...EXAMPLES[environment].map(ofExample)];
            for (const settings of given) {
              const fitted = playground.fit(store.definitions, environment, settings);
              for (const [name, value] of Object.entries(settings)) {
                const cut = name in fitted && String(fitted[name]) !== String(value);
                if (cut) changed.push([environment, name, value, fitted[name]]);
              }
            }
          }
          return changed;
        }"""
    )
    assert changed == []


HOSTILE = (
    "#env=__proto__",
    "#env=constructor&learning_rate=1e999&discount=NaN&epsilon=-1",
    "#env=<img src=x onerror=alert(1)>&algorithm=<script>alert(1)</script>",
    "#env=grid&layout=" + "/".join(["S" * 400] * 400),
    "#env=grid&layout=S.</../..&rewards=99,99,1e999&wind=9e9",
    "#env=grid&layout=.../...",
    "#env=MountainCar-v0&scale=1e-300,1e300&tiles=99999999,99999999&bins=0,0&discretizer=bins",
    "#env=MountainCar-v0&discretizer=identity&algorithm=dyna_q&seeds=1000000&seed=-1",
    "#env=MountainCar-v0&discretizer=tiles&algorithm=dyna_q&terminal_update=assign&episodes=10",
    "#env=CartPole-v1&low=1,1,1,1&high=0,0,0,0&episodes=10",
    "#env=CartPole-v1&discretizer=round&scale=1,1,1,1&episodes=10",
    "?env=CliffWalking-v1&example=999999999999&__proto__=1&toString=2#hasOwnProperty=3",
    "#" + "a=1&" * 20_000,
    "#%E0%A4%A&%%%",
)


@pytest.mark.parametrize("fragment", HOSTILE, ids=range(len(HOSTILE)))
def test_a_hostile_address_only_sets_controls(playground: Playground, fragment: str) -> None:
    playground.page.on("dialog", lambda dialog: playground.problems.append(dialog.message))
    playground.open(fragment)
    _assert_allowed(playground)
    assert playground.page.locator("img, script[src], iframe, object, embed").count() == 0


NAMES = ["env", "seed", "seeds", "example", "layout", "wind", "rewards", *definitions()["settings"]]
WORDS = st.one_of(
    st.sampled_from(
        [*definitions()["environments"], "tiles", "bins", "round", "dyna_q", "softmax", "assign", "visits"]
    ),
    st.floats().map(str),
    st.lists(st.floats(), min_size=1, max_size=4).map(lambda numbers: ",".join(map(str, numbers))),
    st.text(max_size=12),
)


@settings(
    max_examples=settings().max_examples // 4,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
    deadline=None,
)
@given(st.lists(st.tuples(st.sampled_from(NAMES), WORDS), max_size=8))
def test_any_address_only_sets_controls(playground: Playground, parts: list[tuple[str, str]]) -> None:
    if not playground.requests:
        playground.open("#env=CliffWalking-v1")
    text = playground.page.evaluate("parts => new URLSearchParams(parts).toString()", parts)
    short = "&episodes=3&max_episode_steps=20"
    playground.page.evaluate("text => { playground.restore(playground.store, text); }", text + short)
    _assert_allowed(playground)
    playground.page.wait_for_function("() => !['training', 'loading'].includes(playground.training.state)")
    if playground.page.evaluate("() => playground.training.state") == "refused":
        assert "MiB" in playground.text("problem") or "rows" in playground.text("problem")


def _assert_allowed(playground: Playground) -> None:
    """Every setting has a value that its control could give it."""
    known, state = definitions(), playground.state()
    assert state["environment"] in known["environments"]
    assert state["seeds"] in (1, 16)
    assert isinstance(state["seed"], int)
    for name, value in state["settings"].items():
        definition = known["settings"][name]
        if definition["type"] == "flag":
            assert isinstance(value, bool)
            continue
        if definition["type"] == "choice":
            assert value in [choice["value"] for choice in definition["choices"]]
            continue
        high = 2 if name == "learning_rate" else definition["high"]
        for number in value if isinstance(value, list) else [value]:
            assert isinstance(number, int | float)
            assert definition["low"] is None or number >= definition["low"]
            assert high is None or number <= high
    if state["grid"]:
        assert len(state["grid"]["layout"]) <= 20
        assert all(set(row) <= set(".#SG") for row in state["grid"]["layout"])


def test_settings_are_shared_between_pages_that_are_files(playground: Playground) -> None:
    playground.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    playground.open("#env=CliffWalking-v1&algorithm=sarsa&episodes=20&seed=4")
    state = playground.state()
    playground.page.locator("#share-open").click()
    assert "file on your computer" in playground.text("share-text")
    playground.page.locator("#share-copy").click()
    playground.page.wait_for_function("() => document.querySelector('#share-copy').textContent === 'Copied'")
    shared = playground.page.evaluate("() => navigator.clipboard.readText()")
    assert shared.startswith("#env=CliffWalking-v1&")
    for text in (
        shared,
        f"https://example.org/playground/{shared}",
        f"file:///elsewhere/page.html{shared}",
        shared[1:],
    ):
        playground.open("#env=FrozenLake-v1&episodes=20")
        playground.page.keyboard.press("l")
        playground.page.locator("#share-given").fill(text)
        playground.page.locator("#share-given").press("Enter")
        assert playground.settled().state() == state, text
        assert playground.page.locator("#share-dialog").is_hidden()
        assert not playground.page.locator("#problem").is_visible()


def test_shared_settings_that_do_not_fit_are_named(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&episodes=20")
    playground.page.locator("#share-open").click()
    playground.page.locator("#share-given").fill("http://a.b/?env=CliffWalking-v1&episodes=9e9&discount=2&nothing=1")
    playground.page.locator("#share-restore").click()
    playground.settled()
    assert playground.text("problem").endswith("left out or changed: nothing, episodes, discount.")


def test_a_shared_link_is_read_as_by_the_page(playground: Playground) -> None:
    for link, seed in (("?utm=1#env=CliffWalking-v1&seed=3", 3), ("?env=CliffWalking-v1#seed=4", 4)):
        playground.open("#env=FrozenLake-v1&episodes=20")
        playground.page.locator("#share-open").click()
        playground.page.locator("#share-given").fill(f"https://example.org/playground/{link}")
        playground.page.locator("#share-restore").click()
        state = playground.settled().state()
        assert (state["environment"], state["seed"]) == ("CliffWalking-v1", seed)


def test_a_text_without_settings_changes_nothing(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&episodes=20&seed=4")
    state = playground.state()
    playground.page.locator("#share-open").click()
    playground.page.locator("#share-restore").click()
    assert playground.page.locator("#share-dialog").is_visible()
    for text in ("garbage", "https://example.org/?utm=1#top", "env=CliffWalking-v1&" * 500):
        playground.page.locator("#share-given").fill(text)
        playground.page.locator("#share-restore").click()
        assert playground.text("problem").startswith("Nothing was changed: ")
        assert playground.state() == state
        playground.page.locator("#share-open").click()
