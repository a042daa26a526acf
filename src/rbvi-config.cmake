# find_package(rbvi [COMPONENTS online offline c]): the targets rbvi::online, rbvi::offline and rbvi::c,
# the library of rbvi.h.
if(NOT rbvi_FIND_COMPONENTS)
  set(rbvi_FIND_COMPONENTS online offline)
endif()
include(${CMAKE_CURRENT_LIST_DIR}/rbvi-dependencies.cmake)
foreach(component ${rbvi_FIND_COMPONENTS})
  include(${CMAKE_CURRENT_LIST_DIR}/rbvi-${component}.cmake OPTIONAL RESULT_VARIABLE found)
  if(NOT found)
    set(rbvi_FOUND FALSE)
    set(rbvi_NOT_FOUND_MESSAGE "rbvi has no component ${component}: it has online, offline and c")
  endif()
endforeach()
