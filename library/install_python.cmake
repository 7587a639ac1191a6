# Installs the Python module where the Python of this build looks for it below the prefix.
execute_process(COMMAND ${NEPH_PYTHON} ${NEPH_PYTHON_SOURCES}/place.py ${CMAKE_INSTALL_PREFIX}
  OUTPUT_VARIABLE place OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
set(folder ${CMAKE_INSTALL_PREFIX}/${place}/neph)
file(GLOB sources ${NEPH_PYTHON_SOURCES}/neph/*.py)
file(INSTALL ${sources} DESTINATION ${folder})
file(RELATIVE_PATH library /${place}/neph /${NEPH_LIBRARY})
file(WRITE $ENV{DESTDIR}${folder}/_installed.py "LIBRARY = \"${library}\"\n")
list(APPEND CMAKE_INSTALL_MANIFEST_FILES ${folder}/_installed.py)
