"""The package as a whole: its examples, its types, what it exports."""

import ast
import dataclasses
import doctest
import inspect
from importlib import metadata
from pathlib import Path

import relume
from relume import _emitters, _relume

FOLDER = Path(relume.__file__).parent
# What `relume.Emitters` calls.
OF_EMITTERS = {"emitters", "load_emitters", "emitter_poses", "set_pose", "light_at", "sampled_light_at", "incident"}


def test_the_examples_in_the_docstrings_are_true():
    for module, count in ((relume, 9), (_emitters, 5)):
        outcome = doctest.testmod(module)
        assert outcome.attempted >= count
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
    of_classes = {"bake_glossy", "shade_glossy", "shade_glossy_near", "surfaces", "bake_direct", "shade_direct", "shade_direct_near", *OF_EMITTERS}
    assert {f.__name__ for f in functions} == native - of_classes
    for made in classes:
        # Without one of its own, a dataclass is given its signature.
        assert not made.__doc__.startswith(made.__name__ + "("), made
        fields = dataclasses.fields(made) if dataclasses.is_dataclass(made) else ()
        assert all(field.name in made.__doc__ for field in fields if field.repr), made
    emitters = relume.Emitters
    methods = [emitters.load, emitters.pose, emitters.set_pose, emitters.light_at, emitters.sampled_light_at, emitters.incident]
    for function in functions + methods:
        assert function.__doc__
        signature = inspect.signature(function)
        assert signature.return_annotation is not signature.empty
        assert all(p.annotation is not p.empty for p in signature.parameters.values() if p.name != "self")
        # Every argument is explained.
        assert all(name in function.__doc__ for name in signature.parameters if name != "self")


def test_versions_agree():
    assert relume.__version__ == metadata.version("relume")
