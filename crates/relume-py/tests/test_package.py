"""The package as a whole: its examples, its types, what it exports."""

import ast
import dataclasses
import doctest
import inspect
from importlib import metadata
from pathlib import Path

import relume
from relume import _relume

FOLDER = Path(relume.__file__).parent


def test_the_examples_in_the_docstrings_are_true():
    outcome = doctest.testmod(relume)
    assert outcome.attempted >= 9
    assert outcome.failed == 0


def test_the_stubs_of_the_native_half_are_those_of_its_functions():
    tree = ast.parse((FOLDER / "_relume.pyi").read_text(encoding="utf-8"))
    stubs = {node.name: node.args for node in tree.body if isinstance(node, ast.FunctionDef)}
    native = {name: value for name, value in vars(_relume).items() if callable(value) and not name.startswith("_")}
    assert stubs.keys() == native.keys()
    for name, function in native.items():
        positional, keywords = ([p.arg for p in kind] for kind in (stubs[name].args, stubs[name].kwonlyargs))
        parameters = inspect.signature(function).parameters.values()
        assert positional == [p.name for p in parameters if p.kind is p.POSITIONAL_OR_KEYWORD], name
        assert keywords == [p.name for p in parameters if p.kind is p.KEYWORD_ONLY], name


def test_what_is_public_is_annotated_and_says_what_it_does():
    assert (FOLDER / "py.typed").is_file()
    public = [getattr(relume, name) for name in relume.__all__ if name != "__version__"]
    functions, classes = [f for f in public if not inspect.isclass(f)], [c for c in public if inspect.isclass(c)]
    native = {name for name in vars(_relume) if not name.startswith("_")}
    assert {f.__name__ for f in functions} == native - {"bake_glossy", "shade_glossy", "surfaces"}
    for made in classes:
        # Without one of its own, a dataclass is given its signature.
        assert not made.__doc__.startswith(made.__name__), made
        assert all(field.name in made.__doc__ for field in dataclasses.fields(made) if field.repr), made
    for function in functions:
        assert function.__doc__
        signature = inspect.signature(function)
        assert signature.return_annotation is not signature.empty
        assert all(p.annotation is not p.empty for p in signature.parameters.values())
        # Every argument is explained.
        assert all(name in function.__doc__ for name in signature.parameters)


def test_versions_agree():
    assert relume.__version__ == metadata.version("relume")
