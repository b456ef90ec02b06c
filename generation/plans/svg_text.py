"""The text of an SVG drawing, checked before anything is drawn of it.

XML that is broken, declares entities or nests without end is refused, as are numbers that are none, which a drawing
program would silently skip. Source: SVG 1.1 (W3C, 2011), chapters 5, 7, 8 and 9.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NamedTuple

from lxml import etree

from flocking.errors import InputError
from generation.checking import MOST_PIECES
from generation.plans.units import METRES, Unit

NAMESPACE = "http://www.w3.org/2000/svg"
NOT_DRAWN = ("clipPath", "mask", "marker", "pattern", "metadata", "filter", "linearGradient", "radialGradient")
"""Elements whose shapes are no part of the drawing."""
SHAPES = ("line", "polyline", "polygon", "rect", "circle", "ellipse", "path")
_LENGTHS = ("x", "y", "x1", "y1", "x2", "y2", "cx", "cy", "r", "rx", "ry", "width", "height")
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?"
_LENGTH = re.compile(rf"\s*({_NUMBER})\s*(%|[a-zA-Z]*)\s*")
_POINTS = re.compile(rf"(?:[,\s]|{_NUMBER})*")
_PATH = re.compile(rf"(?:[MmZzLlHhVvCcSsQqTtAa,\s]|{_NUMBER})*")
_TRANSFORM = re.compile(rf"(?:[,\s]|(?:matrix|translate|scale|rotate|skewX|skewY)\s*\((?:[,\s]|{_NUMBER})*\))*")
_CURVED = re.compile("[CcSsQqTtAa]")
_OF_CSS = ("mm", "cm", "in", "pt", "pc", "px")
_DEEPEST, _MOST_USES = 300, 64
"""How deep elements may lie, and how many uses within uses. Choices."""


class Text(NamedTuple):
    """A drawing whose user units are pixels, and what its own unit is."""

    root: Any
    """The XML tree: what is never drawn is taken out, and its size is in user units."""
    unit: Unit | None
    """Of its user units; None where its size has no physical unit."""


def checked(data: bytes, path: Path) -> Text:
    """The drawing of an SVG file. Raises `InputError`."""
    root = _parsed(data, path)
    for element in list(root.iter()):
        if not isinstance(element.tag, str) or _name(element) in NOT_DRAWN:  # a comment, an instruction
            parent = element.getparent()
            if parent is not None:
                _take_out(parent, element)
    _check_uses(root, path)
    pieces = 0
    for element in root.iter():
        given = element.get("transform")
        if given is not None and _TRANSFORM.fullmatch(given) is None:
            raise InputError(f"{path}: transform = {given[:60]!r}: expected as in translate(3, 4) rotate(90)")
        if _name(element) in SHAPES:
            pieces += _least_pieces(element, path)
    if pieces > MOST_PIECES:
        raise InputError(f"{path} has more than {MOST_PIECES} straight pieces of wall: expected fewer")
    return Text(root, _size_in_user_units(root, path))


def _parsed(data: bytes, path: Path) -> Any:
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    if b"<!ENTITY" in data or "<!ENTITY".encode("utf-16-le") in data or "<!ENTITY".encode("utf-16-be") in data:
        raise InputError(f"{path} declares XML entities, which are not followed: expected an SVG saved without them")
    try:
        root = etree.fromstring(data, parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        raise InputError(f"{path} is no SVG: broken XML, {error}") from None
    if _name(root) != "svg":
        raise InputError(f"{path} is no SVG: its first element is <{_name(root)[:40]}>, expected <svg>")
    return root


def _name(element: Any) -> str:
    """An element's name without its namespace; empty for comments and for elements of other namespaces."""
    if not isinstance(element.tag, str):
        return ""
    found = etree.QName(element)
    return str(found.localname) if found.namespace in (NAMESPACE, None) else ""


def _take_out(parent: Any, element: Any) -> None:
    tail = element.tail
    parent.remove(element)
    element.tail = tail


def _check_uses(root: Any, path: Path) -> None:
    """Refuses symbols with a viewport of their own, uses that hold themselves, and too many of them.

    Symbols are put where shapes are that are drawn only where they are used.
    """
    by_id = {element.get("id"): element for element in root.iter() if element.get("id")}
    for symbol in [element for element in root.iter() if _name(element) == "symbol"]:
        if symbol.get("viewBox"):
            raise InputError(f"{path}: <symbol> with a viewBox is not followed; expected unlinked symbols")
        holder = etree.Element(etree.QName(NAMESPACE, "defs"))
        symbol.getparent().replace(symbol, holder)
        holder.append(symbol)
    sizes: dict[Any, int] = {}

    def size(element: Any, depth: int, within: tuple[Any, ...]) -> int:
        """How many elements are drawn for one."""
        if element in sizes:
            return sizes[element]
        if depth > _DEEPEST or element in within or len(within) > _MOST_USES:
            raise InputError(f"{path}: <{_name(element)}> {element.get('id') or ''} is used within itself, or too deep")
        found = 1 + sum(size(child, depth + 1, within) for child in element if isinstance(child.tag, str))
        if _name(element) == "use":
            link = element.get("href") or element.get("{http://www.w3.org/1999/xlink}href") or ""
            target = by_id.get(link.removeprefix("#")) if link.startswith("#") else None
            if target is None:
                raise InputError(f"{path}: <use> of {link[:60]!r}: expected #id of an element in the drawing")
            found += size(target, depth + 1, (*within, element))
        sizes[element] = found
        return found

    if size(root, 0, ()) > MOST_PIECES:
        raise InputError(f"{path} draws more than {MOST_PIECES} elements: expected fewer")


def _least_pieces(element: Any, path: Path) -> int:
    """The fewest straight pieces that a shape can have. Refuses one whose numbers are none."""
    name, pieces = _name(element), 0
    for key in _LENGTHS:
        given = element.get(key)
        if given is not None and given.strip() != "auto" and _length(given) is None:
            raise InputError(f"{path}: <{name}> has {key} = {given[:40]!r}: expected a length")
    for key, pattern in (("points", _POINTS), ("d", _PATH)):
        given = element.get(key)
        if given is None:
            continue
        sound = pattern.match(given)
        end = sound.end() if sound else 0
        if end < len(given):
            raise InputError(f"{path}: <{name}> has {key} with {given[end : end + 40]!r}: expected numbers")
        numbers = len(re.findall(_NUMBER, given))
        pieces += numbers // (7 if _CURVED.search(given) else 2)
        if key == "points" and numbers % 2:
            raise InputError(f"{path}: <{name}> has an odd number of coordinates: expected x and y of each point")
    return pieces


def _length(text: str) -> tuple[float, str] | None:
    """A number and its unit, of a length."""
    found = _LENGTH.fullmatch(text)
    if found is None or found[2] not in ("", "%", *_OF_CSS):
        return None
    return float(found[1]), found[2]


def _size_in_user_units(root: Any, path: Path) -> Unit | None:
    """Makes the drawing's user units pixels, by taking away its viewBox; what they were, None where nothing says so."""
    view = _view_box(root, path)
    lengths = {key: _length(root.get(key) or "") for key in ("width", "height")}
    metres = {key: found[0] * METRES[found[1]] for key, found in lengths.items() if found and _is_physical(found)}
    if view is None:
        return Unit(METRES["px"], "one pixel of CSS") if metres else None
    root.attrib.pop("viewBox")
    root.attrib.pop("preserveAspectRatio", None)
    scales = [metres[key] / size for key, size in zip(("width", "height"), view, strict=True) if key in metres]
    root.set("width", repr(view[0]))
    root.set("height", repr(view[1]))
    if not scales:
        return None
    if len(scales) == 2 and abs(scales[0] - scales[1]) > 1e-3 * max(scales):
        raise InputError(
            f"{path}: its viewBox makes one unit {scales[0]:g} m in x and {scales[1]:g} m in y: expected the same"
        )
    return _nicely(scales[0])


def _is_physical(length: tuple[float, str]) -> bool:
    return length[1] in _OF_CSS and length[1] != "px" and length[0] > 0.0


def _view_box(root: Any, path: Path) -> tuple[float, float] | None:
    given = root.get("viewBox")
    if given is None:
        return None
    try:
        _, _, width, height = (float(part) for part in re.split(r"[\s,]+", given.strip()))
    except ValueError:
        width = height = 0.0
    if not (0.0 < width < 1e12 and 0.0 < height < 1e12):
        raise InputError(f"{path}: viewBox = {given[:60]!r}: expected four numbers, of which the last two are above 0")
    return width, height


def _nicely(metres: float) -> Unit:
    """The unit of that name, where it is one but for rounding."""
    for name in ("mm", "cm", "m", "in", "ft", "pt", "px"):
        if abs(metres - METRES[name]) < 1e-6 * METRES[name]:
            return Unit(METRES[name], name)
    return Unit(metres, f"{metres:.6g} m")
