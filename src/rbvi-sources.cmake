# Which files are in which library.
function(rbvi_sources result)
  set(found)
  foreach(layer ${ARGN})
    file(GLOB_RECURSE files CONFIGURE_DEPENDS ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/${layer}/*.cpp)
    list(APPEND found ${files})
  endforeach()
  if(NOT ARGN MATCHES "published")
    list(FILTER found EXCLUDE REGEX "/published/")
  endif()
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# What all libraries hold: core to model. Answers have the same digits in each of them: no
# instructions of this machine's processor, nothing contracted. One file alone knows HDF5, which there
# are two of: no process must hold both; those that write files are apart, too. One file alone knows
# YAML.
rbvi_sources(common_sources core method io element contact scene model)
set(stored_sources ${common_sources})
set(with_files "/(model_file|model_fields|online_batch|online_texts|online_tool|write_atomically|vtu|solution_files|zip|fmu)\\.cpp$")
list(FILTER common_sources EXCLUDE REGEX "/(io/h5|scene/document)\\.cpp$")
list(FILTER common_sources EXCLUDE REGEX ${with_files})
list(FILTER stored_sources INCLUDE REGEX ${with_files})
# The published variants of queries.
rbvi_sources(query_sources method/published model/published)
