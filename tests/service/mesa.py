#!/usr/bin/python3
"""Prints the number of Mesa's software device among this machine's EGL devices, for sheend's --device. Exit code 1 if
there is none."""
import ctypes
import sys


def device():
    """The device's number as text, or None if there is none."""
    try:
        egl = ctypes.CDLL("libEGL.so.1")
    except OSError:
        return None
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    query = ctypes.CFUNCTYPE(ctypes.c_uint, ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(ctypes.c_int))(
        egl.eglGetProcAddress(b"eglQueryDevicesEXT"))
    text = ctypes.CFUNCTYPE(ctypes.c_char_p, ctypes.c_void_p, ctypes.c_int)(
        egl.eglGetProcAddress(b"eglQueryDeviceStringEXT"))
    devices, n = (ctypes.c_void_p * 64)(), ctypes.c_int(0)
    extensions = 0x3055  # EGL_EXTENSIONS
    query(len(devices), devices, ctypes.byref(n))
    for i in range(n.value):
        if b"EGL_MESA_device_software" in (text(devices[i], extensions) or b"").split():
            return str(i)
    return None


if __name__ == "__main__":
    sys.exit(print(device()) if device() else 1)
