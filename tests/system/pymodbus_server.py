#!/usr/bin/python3
"""usage: pymodbus_server.py tcp PORT | rtu TTY

A Modbus server that is not ours, with the holding registers of a Eurotherm 3000: 31.25, 31.75, 31.5
and 21.0 degC, target 30.0 degC, mode off, 0 W. Runs until it is killed.
"""
import struct
import sys

from pymodbus.datastore import ModbusServerContext, ModbusSlaveContext, ModbusSparseDataBlock
from pymodbus.server import StartSerialServer, StartTcpServer
from pymodbus.transaction import ModbusRtuFramer

registers = {2: 300, 5: 300, 75: 0, 85: 0, 86: 0, 273: 0}
for address, celsius in ((0x8002, 31.25), (0x8244, 31.75), (0x8246, 31.5), (0x81AE, 21.0)):
    high, low = struct.unpack(">HH", struct.pack(">f", celsius))
    registers[address], registers[address + 1] = high, low

unit = ModbusSlaveContext(hr=ModbusSparseDataBlock(registers), zero_mode=True)
context = ModbusServerContext(slaves={1: unit}, single=False)
if sys.argv[1] == "tcp":
    StartTcpServer(context=context, address=("127.0.0.1", int(sys.argv[2])))
else:
    StartSerialServer(context=context, framer=ModbusRtuFramer, port=sys.argv[2], baudrate=19200,
                      bytesize=8, parity="N", stopbits=1)
