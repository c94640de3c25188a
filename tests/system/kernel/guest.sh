echo hello; uname -a; uptime; cat /proc/uptime; ls / | head -3; lsmod 2>/dev/null; cat /proc/modules | cut -d' ' -f1; time python3 -c 'print(1)'; ls /dev/pts; ls /sys/devices/platform/; usbip port; cat /proc/uptime
time /work/main/build/release/fogbench --version
