// The plug-in sensorfarm_python.so: runs the controllers of a Python file in the program's own interpreter, or in the
// interpreter that has loaded the farm.

#include <dlfcn.h>
#include <pybind11/embed.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "python/controllers.h"
#include "sensorfarm/plugin.h"

namespace sensorfarm::python {

namespace py = pybind11;
namespace fs = std::filesystem;

namespace {

/// Returns the Python of an active virtual environment of this version, or the Python that the plug-in was built with,
/// so that its modules are found.
std::string interpreter_file() {
  const char* const environment = std::getenv("VIRTUAL_ENV");
  std::error_code ignored;
  const fs::path own = fs::path(environment != nullptr ? environment : "") / "bin" / "python" SF_PYTHON_VERSION;
  return environment != nullptr && fs::exists(own, ignored) ? own.string() : SF_PYTHON;
}

/// Returns the folder of this plug-in.
fs::path own_folder() {
  Dl_info info = {};
  dladdr(reinterpret_cast<const void*>(&interpreter_file), &info);
  std::error_code ignored;
  return fs::canonical(info.dli_fname, ignored).parent_path();
}

/// Waits for Python's threads, runs `atexit` handlers and flushes the output.
void finish() {
  PyGILState_Ensure();
  Py_FinalizeEx();
}

/// Starts the interpreter. The program keeps its signal handlers. The interpreter's symbols become visible to its
/// compiled modules (numpy).
void start() {
  Dl_info info = {};
  dladdr(reinterpret_cast<const void*>(&Py_IsInitialized), &info);
  dlopen(info.dli_fname, RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD);
  PyConfig config;
  PyConfig_InitPythonConfig(&config);
  config.install_signal_handlers = 0;
  config.parse_argv = 0;
  PyStatus status = PyConfig_SetBytesString(&config, &config.program_name, interpreter_file().c_str());
  if (PyStatus_Exception(status) == 0) status = Py_InitializeFromConfig(&config);
  PyConfig_Clear(&config);
  if (PyStatus_Exception(status) != 0)
    throw std::runtime_error(std::string("Python does not start: ") +
                             (status.err_msg != nullptr ? status.err_msg : "?"));
  PyEval_SaveThread();  // threads of controllers acquire the GIL in turn
  std::atexit(finish);
}

/// Requires the GIL.
void prepare() {
  static bool prepared = false;
  if (prepared) return;
  py::module_::import("numpy");  // before any thread needs it
  const fs::path package = own_folder() / "python";
  if (fs::exists(package)) py::module_::import("sys").attr("path").attr("append")(package.string());
  py::module_ types = py::reinterpret_steal<py::module_>(PyModule_New("sensorfarm_python"));
  add_controller_types(types);
  types.release();
  prepared = true;
}

/// Loads the file as a separate module. Its folder is searched for modules first, as Python does for scripts.
py::object module_of(const std::string& file) {
  const py::module_ util = py::module_::import("importlib.util");
  const py::module_ sys = py::module_::import("sys");
  sys.attr("path").attr("insert")(0, fs::path(file).parent_path().string());
  const py::object spec = util.attr("spec_from_file_location")(file, file);
  const py::object module = util.attr("module_from_spec")(spec);
  sys.attr("modules")[py::str(file)] = module;
  spec.attr("loader").attr("exec_module")(module);
  return module;
}

bool is_class_of(py::handle value, const std::string& file) {
  return PyType_Check(value.ptr()) != 0 && py::str(value.attr("__module__")).cast<std::string>() == file &&
         py::str(value.attr("__name__")).cast<std::string>().front() != '_';
}

void fill(const std::string& file, Plugin& plugin) {
  if (Py_IsInitialized() == 0) start();
  const py::gil_scoped_acquire gil;
  std::string without_step;
  try {
    prepare();
    const py::object module = module_of(file);
    for (const py::handle value : module.attr("__dict__").attr("values")()) {
      if (!is_class_of(value, file)) continue;
      if (py::hasattr(value, "step"))
        plugin.controllers.push_back(entry_of(value));
      else if (py::hasattr(value, "tick"))
        plugin.models.push_back(model_entry_of(value));
      else if (py::hasattr(value, "take") && py::hasattr(value, "read"))
        plugin.derived.push_back(derived_entry_of(value, file));
      else if (without_step.empty())
        without_step =
            "; " + place_of(value) + "class " + py::str(value.attr("__name__")).cast<std::string>() + " has none";
    }
  } catch (py::error_already_set& error) {
    throw std::runtime_error(last_line(error, file));
  }
  if (plugin.controllers.empty() && plugin.models.empty() && plugin.derived.empty())
    throw std::runtime_error(
        "it has no class with a method step(self, input), tick(self, model), or take(self, input, reading) and "
        "read(self, time)" +
        without_step);
}

}  // namespace

}  // namespace sensorfarm::python

/// Adds the classes of `file` (a canonical path) that have a method `step`, `tick`, or `take` and `read`. @throws
/// std::exception
extern "C" __attribute__((visibility("default"))) void sensorfarm_python(const char* file, sensorfarm::Plugin& plugin) {
  sensorfarm::python::fill(file, plugin);
}
