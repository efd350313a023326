"""Kernels with one name and several bodies: the type of the first argument picks one when a caller is compiled.

What `functools.singledispatch` is for Python: whoever calls such a name is written once, and compiled for each kind of
constants that it is given; nothing is decided while it runs.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import types
from numba.core.typing.templates import AbstractTemplate, infer, infer_global
from numba.extending import lower_builtin

from vines.kernels._bodies import Body, note_body

__all__ = ["ByType", "by_type"]


class ByType:
    """A name of kernels, called with a named tuple first.

    Parameters
    ----------
    kind : type
        The class of named tuples for which the first body is.
    kernel : kernel
        That body; its name and docstring are those of all.
    """

    def __init__(self, kind: type, kernel: Any) -> None:
        self.bodies: dict[type, Any] = {kind: kernel}
        self.__name__: str = kernel.__name__
        self.__module__ = kernel.__module__
        self.__doc__ = kernel.__doc__
        self.__wrapped__ = kernel.py_func
        template = type(f"{self.__name__}_by_type", (AbstractTemplate,), {"key": self, "generic": self._typed()})
        infer(template)
        infer_global(self, types.Function(template))
        lower_builtin(self, types.VarArg(types.Any))(self._lower)

    @property
    def first(self) -> Any:
        """The body that the name was made of, whose function is called as it is."""
        return next(iter(self.bodies.values()))

    def register(self, kind: type) -> Callable[[Any], Any]:
        """Return a decorator that takes a kernel as the body for named tuples of a class.

        Parameters
        ----------
        kind : type
            The class. Its body has to be there before a kernel that calls it with such a tuple is compiled, so it
            belongs into the room of the class.
        """

        def decorate(kernel: Any) -> Any:
            self.bodies[kind] = kernel
            return kernel

        return decorate

    def __call__(self, first: Any, *arguments: Any) -> Any:
        return self.bodies[type(first)](first, *arguments)

    def _body(self, kind: Any) -> Any:
        return self.bodies.get(getattr(kind, "instance_class", type(None)))

    def _typed(self) -> Callable[..., Any]:
        def generic(template: Any, arguments: tuple[Any, ...], named: dict[str, Any]) -> Any:
            body = self._body(arguments[0]) if arguments else None
            if body is None:
                return None
            kind = arguments[0].instance_class
            note_body(
                Body(self.__module__, self.__name__, body.py_func.__module__, f"{kind.__module__}.{kind.__qualname__}")
            )
            return template.context.resolve_value_type(body).get_call_type(template.context, arguments, named)

        return generic

    def _lower(self, context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
        kernel = context.typing_context.resolve_value_type(self._body(sig.args[0]))
        kernel.get_call_type(context.typing_context, sig.args, {})
        return context.get_function(kernel, sig)(builder, arguments)


def by_type(kind: type) -> Callable[[Any], ByType]:
    """Return a decorator that makes of a kernel a name whose body is picked by the type of its first argument.

    Parameters
    ----------
    kind : type
        The class of named tuples for which this body is; others are added by `ByType.register`.

    Examples
    --------
    >>> from typing import NamedTuple
    >>> from vines.kernels import by_type, njit
    >>> class Square(NamedTuple):
    ...     side: float
    >>> class Circle(NamedTuple):
    ...     radius: float
    >>> @by_type(Square)
    ... @njit
    ... def area(of):
    ...     return of.side**2
    >>> @area.register(Circle)
    ... @njit
    ... def area_of_circle(of):
    ...     return 3.0 * of.radius**2
    >>> area(Square(2.0)), area(Circle(2.0))
    (4.0, 12.0)
    """
    return lambda kernel: ByType(kind, kernel)
