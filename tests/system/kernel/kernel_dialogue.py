"""Talks to a simulated supply through the kernel's own USBTMC driver: /dev/usbtmc0."""

import errno
import fcntl
import os
import struct

# linux/usb/tmc.h
CLEAR = 0x5B02
SET_TIMEOUT = 0x40045B0A  # ms
READ_STATUS_BYTE = 0x80015B12

supply = os.open("/dev/usbtmc0", os.O_RDWR)


def ask(question):
    os.write(supply, question + b"\n")
    return os.read(supply, 1000).decode().strip()


def status_byte():
    answer = bytearray(1)
    fcntl.ioctl(supply, READ_STATUS_BYTE, answer)
    return answer[0]


print("identity", ask(b"*IDN?"))
print("status byte", status_byte())

# Nothing was asked: the kernel waits in vain. What comes next must not be disturbed by that. (Its
# own abort names a tag that was never used, so a device refuses it: a clear is what helps.)
fcntl.ioctl(supply, SET_TIMEOUT, struct.pack("I", 500))
try:
    print("unasked", os.read(supply, 1000))
except OSError as error:
    print("unasked", errno.errorcode[error.errno])
fcntl.ioctl(supply, CLEAR)
print("after a time-out", ask(b"CURR?"))

# An answer that nobody fetches is forgotten.
os.write(supply, b"*IDN?\n")
fcntl.ioctl(supply, CLEAR)
print("after a clear", ask(b"CURR?"))
os.close(supply)
