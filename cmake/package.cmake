# What is installed where, and the Debian package that `cpack -G DEB` makes of it; scripts/package
# builds and checks it. The programs find their ready files from where they are themselves
# (config/paths.hpp), so any prefix does.

include(GNUInstallDirs)
set(FOGBENCH_MAINTAINER "fogbench maintainers <fogbench@localhost.localdomain>" CACHE STRING
  "Whom the Debian package names for questions: Name <mail>")

install(TARGETS fogbench RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS fogbenchd RUNTIME DESTINATION ${CMAKE_INSTALL_SBINDIR})
foreach(kind benches data devices limits models procedures scenarios schemas)
  install(DIRECTORY config/${kind} DESTINATION ${CMAKE_INSTALL_DATADIR}/fogbench/config)
endforeach()
install(FILES daemon/README.md daemon/protocol.md record/run-log.md
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/fogbench)
install(FILES config/README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/fogbench RENAME config.md)
install(FILES procedures/README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/fogbench RENAME procedures.md)
install(FILES cmake/debian/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/fogbench)
install(FILES config/systemd/fogbenchd.service config/systemd/fogbenchd.socket
  DESTINATION lib/systemd/system)
install(FILES config/systemd/fogbench.sysusers DESTINATION lib/sysusers.d RENAME fogbench.conf)
install(FILES config/udev/60-fogbench.rules DESTINATION lib/udev/rules.d)
install(FILES cmake/debian/fogbenchd.default DESTINATION /etc/default RENAME fogbenchd)
install(DIRECTORY DESTINATION /etc/fogbench)

# The manual pages and the completions are what the programs print, so that they cannot differ.
install(CODE [[
  set(share "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/share")
  function(write_output file program)
    get_filename_component(folder "${file}" DIRECTORY)
    file(MAKE_DIRECTORY "${folder}")
    execute_process(COMMAND ${program} ${ARGN} OUTPUT_FILE "${file}" COMMAND_ERROR_IS_FATAL ANY)
  endfunction()
]])
foreach(page fogbench.1 fogbenchd.8)
  string(REGEX REPLACE "\\.[18]$" "" program ${page})
  string(REGEX REPLACE "^.*\\." "man" section ${page})
  install(CODE "
    write_output(\"\${share}/man/${section}/${page}\" \"$<TARGET_FILE:${program}>\" --manual)
    execute_process(COMMAND gzip -9nf \"\${share}/man/${section}/${page}\" COMMAND_ERROR_IS_FATAL ANY)
    write_output(\"\${share}/bash-completion/completions/${program}\" \"$<TARGET_FILE:${program}>\"
      --completion)")
endforeach()

string(TIMESTAMP FOGBENCH_PACKAGE_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(cmake/debian/changelog.in changelog @ONLY)
install(CODE "
  file(MAKE_DIRECTORY \"\${share}/doc/fogbench\")
  execute_process(COMMAND gzip -9nc \"${PROJECT_BINARY_DIR}/changelog\"
    OUTPUT_FILE \"\${share}/doc/fogbench/changelog.gz\" COMMAND_ERROR_IS_FATAL ANY)")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "${FOGBENCH_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "acceptance tests of fiber-optic gyros")
set(CPACK_PACKAGE_DESCRIPTION
"Runs acceptance procedures of fiber-optic gyros in thermal and magnetic fields
on a bench, real or simulated, logs them, and finds the error model that
explains the measurements. The daemon fogbenchd owns the bench; operators
queue, watch and stop runs with fogbench.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "systemd, udev")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "chromium")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
foreach(file postinst prerm postrm conffiles)
  list(APPEND CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/${file})
endforeach()
include(CPack)
