# SPDX-License-Identifier: MIT
"""libneph_metrics by ctypes: the functions of neph_metrics.h, with errors as exceptions."""
import ctypes
import importlib.util
import os
import pathlib

NAME = "libneph_metrics.so.0"


class Error(Exception):
    """An error of libneph_metrics; `status` is its short name, such as "input"."""

    def __init__(self, status, text):
        super().__init__(text)
        self.status = status


class InputError(Error, ValueError):
    """Images that do not fit each other, a value that is not finite, or an option that is wrong."""


class FrozenError(InputError):
    """Frames of a sequence are equal to the ones before them; `result` has the numbers."""

    result = None


class _ErrorText(ctypes.Structure):
    _fields_ = [("text", ctypes.c_char * 2048)]


class Number(ctypes.Structure):
    """struct nephm_number."""

    _fields_ = [(name, ctypes.c_char_p) for name in ("extractor", "metric", "quantity", "mask",
                                                     "unit")] + [
        ("frame", ctypes.c_int), ("is_defined", ctypes.c_int),
        ("undefined_because", ctypes.c_char_p), ("value", ctypes.c_double),
        ("low", ctypes.c_double), ("high", ctypes.c_double)]


def find():
    """The library: NEPH_METRICS_LIBRARY, beside this file (a wheel), where `cmake --install` put
    it, or where the loader looks."""
    here = pathlib.Path(__file__).resolve().parent
    places = [os.environ.get("NEPH_METRICS_LIBRARY"), here / NAME]
    if importlib.util.find_spec(f"{__package__}._installed"):
        from . import _installed
        places.append(here / _installed.LIBRARY)
    found = (str(place) for place in places if place and pathlib.Path(place).exists())
    return next(found, NAME)


_P, _S, _E = ctypes.c_void_p, ctypes.c_char_p, ctypes.POINTER(_ErrorText)
_OUT, _STRIDE, _COUNT = ctypes.POINTER(_P), ctypes.c_ssize_t, ctypes.c_size_t
# Each function with the types of its arguments. Those that end with an error give a status.
_FUNCTIONS = {
    "nephm_image_create": (ctypes.c_int, ctypes.c_int, _OUT, _E),
    "nephm_image_destroy": (_P,),
    "nephm_image_set_floats": (_P, _S, _P, _STRIDE, _STRIDE, _E),
    "nephm_image_set_srgb_codes": (_P, _S, _P, ctypes.c_int, _STRIDE, _STRIDE, _E),
    "nephm_image_set_text": (_P, _S, _S, _E),
    "nephm_task_create": (ctypes.c_int, _OUT, _E),
    "nephm_task_destroy": (_P,),
    "nephm_task_set": (_P, _S, _S, _E),
    "nephm_task_run": (_P, _OUT, _COUNT, _OUT, _COUNT, _OUT, _E),
    "nephm_result_destroy": (_P,),
    "nephm_result_count": (_P,),
    "nephm_result_number": (_P, _COUNT, ctypes.POINTER(Number), _E),
    "nephm_result_json": (_P,),
    "nephm_status_name": (ctypes.c_int,),
    "nephm_version": (),
}
_RESULTS = {"nephm_result_count": _COUNT, "nephm_result_json": _S, "nephm_status_name": _S,
            "nephm_version": _S}


def _load():
    try:
        library = ctypes.CDLL(find())
    except OSError as error:
        raise ImportError(f"{error}: build and install neph (cmake --install), or name the library "
                          "in NEPH_METRICS_LIBRARY") from error
    for name, arguments in _FUNCTIONS.items():
        function = getattr(library, name)
        function.argtypes = arguments
        function.restype = _RESULTS.get(name, ctypes.c_int if _E in arguments else None)
    return library


library = _load()


def encode(what, text):
    """Text for the library, which ends it at a zero byte."""
    if not isinstance(text, str):
        raise TypeError(f"{what}: {text!r} is no text")
    if "\0" in text:
        raise ValueError(f"{what}: {text!r} has a zero byte")
    try:
        return text.encode()
    except UnicodeEncodeError as error:
        raise ValueError(f"{what}: {text!r}: {error.reason}") from error


def call(name, *arguments):
    """Calls a function that gives a status; raises an error of it."""
    error = _ErrorText()
    code = getattr(library, name)(*arguments, ctypes.byref(error))
    if code:
        status = library.nephm_status_name(code).decode()
        text = error.text.decode("utf-8", "replace")
        if status == "memory":
            raise MemoryError(text)
        kind = {"gate": InputError, "input": InputError, "usage": InputError,
                "unsupported": InputError}
        raise kind.get(status, Error)(status, text)


class Handle:
    """A handle of the library, destroyed with this object."""

    def __init__(self, kind, *arguments):
        self.pointer = _P()
        self._destroy = getattr(library, f"nephm_{kind}_destroy")
        if arguments:
            call(f"nephm_{kind}_create", *arguments, ctypes.byref(self.pointer))

    def __del__(self):
        if getattr(self, "pointer", None):
            self._destroy(self.pointer)
            self.pointer = None
