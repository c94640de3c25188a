"""Another's program talks to a simulated supply: pyvisa with its backend in Python, over libusb."""

import pyvisa

supply = pyvisa.ResourceManager("@py").open_resource("USB0::0x1209::0x0002::SIM-CV-1::INSTR")
print("identity", supply.query("*IDN?").strip())
supply.write("CURR 0.25")
print("set", float(supply.query("CURR?")))
supply.write("CURR 99")
print("refused", supply.query("SYST:ERR?").strip())
supply.write("CURR 0")
print("zero", float(supply.query("CURR?")))
supply.close()
