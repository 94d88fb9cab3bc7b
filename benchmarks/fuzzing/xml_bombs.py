"""XML files that are deep, wide or long, or have entities that want to become so."""

from __future__ import annotations

import random

from fuzzing.bomb import LARGEST, Bomb


def _document(inside: str, before: str = "") -> str:
    head = f'{before}<root BTCPP_format="4" xmlns:momantu="urn:momantu-bt:1">'
    return f'{head}<BehaviorTree ID="Main">{inside}</BehaviorTree></root>'


def _entities(size: int, r: random.Random) -> str:
    levels = min(size, 60)
    lines = ['<!ENTITY e0 "x">']
    lines += [f'<!ENTITY e{i} "{f"&e{i - 1};" * 10}">' for i in range(1, levels)]
    outside = '<!ENTITY e SYSTEM "file:///etc/passwd">'
    long = f'<!ENTITY e "{"x" * size}">'
    inside = r.choice(["".join(lines), outside, long, "<!ENTITY % e 'x'>%e;"])
    text = r.choice([f"&e{levels - 1};", "&e;", "&e;" * min(size, 1000)])
    return _document(f'<Sequence name="{text}">{text}</Sequence>', f"<!DOCTYPE root [{inside}]>")


def _nested(size: int, r: random.Random) -> str:
    name = r.choice(["Sequence", "Inverter", "ReactiveFallback", "momantu:Recover", "Parallel"])
    name = r.choice([name, name, "nonesuch"])
    size = min(size, r.choice([40, 100, LARGEST]))
    closing = f"</{name}>" * (size if r.random() < 0.8 else 0)
    return _document(f"<{name}>" * size + "<AlwaysSuccess/>" + closing)


def _wide(size: int, r: random.Random) -> str:
    item = r.choice(
        [
            "<AlwaysSuccess/>",
            "<relocalize/>",
            '<navigate in_front_of="nowhere"/>',
            '<nonesuch{n} a="1"/>',
            '<SetBlackboard output_key="a{n}" value="1"/>',
            '<Script code="a{n} := 1"/>',
            '<Sleep msec="1s"/>',
            '<Sleep msec="1" name="same"/>',
            '<Sleep b{n}="1"/>',
            '<SubTree ID="T{n}" a="{a}"/>',
            '<AlwaysSuccess _skipIf="a > {n}"/>',
            "<!-- c -->",
            "<?pi x?>",
            "<![CDATA[x]]>",
            "text ",
            '<momantu:Catch codes="A_{n}"/>',
        ]
    )
    name = r.choice(["Sequence", "Parallel", "Fallback", "momantu:Recover", "nonesuch"])
    return _document(
        f"<{name}>{''.join(item.replace('{n}', str(i)) for i in range(size))}</{name}>"
    )


def _long(size: int, r: random.Random) -> str:
    thing = r.choice(["x", "9", " ", "é", "{a}", "&#x41;", "&amp;", ";", "$", "(", "!", "a.", "\n"])
    thing = (thing * (size * r.choice([1, 9])))[:990_000]
    thing = thing[: thing.rfind(";") + 1] if thing.startswith("&") else thing
    return r.choice(
        [
            _document(f'<say text="{thing}"/>'),
            _document(f'<Sleep msec="{thing}"/>'),
            _document(f'<Script code="{thing}"/>'),
            _document(f'<AlwaysSuccess _while="{thing}"/>'),
            _document(f'<say momantu:text="{thing}"/>'),
            _document(f'<momantu:Catch codes="{thing}"/>'),
            _document(f"<Sequence>{thing}</Sequence>"),
            _document(f"<!--{thing}--><AlwaysSuccess/>"),
            _document("<AlwaysSuccess/>", f"<!--{thing}-->"),
            _document(f"<n{thing}/>"),
            _document(f'<a n{thing}="1"/>'),
            f"<root {thing}",
            f"<{thing}",
        ]
    )


def _attributes(size: int, r: random.Random) -> str:
    written = r.choice(['a{n}="1" ', 'a="1" ', 'xmlns:n{n}="u{n}" ', 'momantu:a{n}="[1" '])
    return _document(f"<Sleep {''.join(written.replace('{n}', str(i)) for i in range(size))}/>")


def _calls(size: int, r: random.Random) -> str:
    size, times = min(size, 5000), r.choice([1, 2, 5])
    trees = "".join(
        f'<BehaviorTree ID="T{i}"><Sequence>'
        + f'<SubTree ID="T{i + 1}" _autoremap="true" a="{{a}}"/>' * times
        + "</Sequence></BehaviorTree>"
        for i in range(size)
    )
    last = r.choice(["<AlwaysSuccess/>", '<SubTree ID="T0"/>'])
    end = f'<BehaviorTree ID="T{size}">{last}</BehaviorTree>'
    return f'<root BTCPP_format="4" main_tree_to_execute="T0">{trees}{end}</root>'


def _shared(size: int, r: random.Random) -> str:
    """Trees that share many keys with many that run them."""
    keys = "; ".join(f"k{i} := {i}" for i in range(min(size, r.choice([200, 300, 5000]))))
    scripts = "".join(f'<Script code="{keys[i : i + 3900]}"/>' for i in range(0, len(keys), 3900))
    call = r.choice(
        [
            '<SubTree ID="Sub" _autoremap="true"/>',
            '<SubTree ID="Sub" k1="{k1}" k2="{a{n}}"/>',
            '<SubTree ID="Sub" _autoremap="true" k1="{a}" _skipIf="k2 > 1"/>',
            '<Inverter><SubTree ID="Sub" _autoremap="true"/></Inverter>',
        ]
    )
    wrapped = r.choice([0, 30, 90])
    calls = "".join(call.replace("{n}", str(i)) for i in range(r.choice([100, 1000, 4500])))
    main = f"<ReactiveSequence>{calls}</ReactiveSequence>"
    main = "<ReactiveFallback>" * wrapped + main + "</ReactiveFallback>" * wrapped
    sub = f'<BehaviorTree ID="Sub"><Sequence>{scripts}</Sequence></BehaviorTree>'
    head = '<root BTCPP_format="4" main_tree_to_execute="Main">'
    return f'{head}<BehaviorTree ID="Main">{main}</BehaviorTree>{sub}</root>'


XML_BOMBS: tuple[Bomb, ...] = (
    _entities,
    _nested,
    _wide,
    _long,
    _attributes,
    _calls,
    _shared,
    _shared,
)
