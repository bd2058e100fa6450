// Controllers of models written in Python.

#include <array>
#include <memory>
#include <stdexcept>

#include "python/controllers.h"
#include "python/types.h"

namespace sensorfarm::python {

namespace py = pybind11;

namespace {

/// An object, or the model itself, during a call.
struct LentObject {
  WorldObject* object = nullptr;
  std::shared_ptr<const bool> ended;  ///< the call has returned
  WorldObject& get() const {
    if (*ended) throw py::value_error("a model can be used during the call that receives it only");
    return *object;
  }
};
struct LentModel : LentObject {
  Model& get() const { return static_cast<Model&>(LentObject::get()); }
};

struct OwnedRobot {
  std::string name;
  NearRobot robot;
};

struct OwnedContact {
  std::string name;
  ModelContact contact;
};

py::list robots_of(const LentModel& model) {
  py::list robots;
  for (const NearRobot& robot : model.get().robots()) robots.append(OwnedRobot{std::string(robot.name), robot});
  return robots;
}

/// Errors of `call` become ValueError in Python.
template <class Call>
void change(Call&& call) {
  try {
    call();
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const std::exception& error) {
    throw py::value_error(error.what());
  }
}

void add_object(py::module_& module) {
  using Given = const LentObject&;
  py::class_<LentObject>(module, "WorldObject", py::module_local(), "An object in one call: its state, and changes.")
      .def_property_readonly("pose", [](Given o) { return o.get().pose(); })
      .def_property_readonly("velocity", [](Given o) { return o.get().velocity(); })
      .def_property_readonly("present", [](Given o) { return o.get().present(); })
      .def_property_readonly("changeable", [](Given o) { return o.get().changeable(); })
      .def(
          "set_pose", [](Given o, const Pose& pose) { change([&] { o.get().set_pose(pose); }); }, py::arg("pose"))
      .def(
          "set_velocity", [](Given o, const Twist& twist) { change([&] { o.get().set_velocity(twist); }); },
          py::arg("velocity"))
      .def(
          "set_present", [](Given o, bool present) { o.get().set_present(present); }, py::arg("present"))
      .def(
          "set_shape", [](Given o, const std::string& name) { change([&] { o.get().set_shape(name); }); },
          py::arg("name"))
      .def(
          "set_size",
          [](Given o, const std::array<double, 3>& s) { change([&] { o.get().set_size(s[0], s[1], s[2]); }); },
          py::arg("size"))
      .def(
          "set_color", [](Given o, const std::string& color) { change([&] { o.get().set_color(color); }); },
          py::arg("color"));
}

void add_model(py::module_& module) {
  using Given = const LentModel&;
  py::class_<LentModel, LentObject>(module, "Model", py::module_local(), "The controller's own model in one call.")
      .def_property_readonly("time", [](Given m) { return m.get().time(); })
      .def_property_readonly("robots", &robots_of)
      .def(
          "object",
          [](Given m, const std::string& name) {
            LentObject object{nullptr, m.ended};
            change([&] { object.object = &m.get().object(name); });
            return object;
          },
          py::arg("name"))
      .def("uniform", [](Given m) { return m.get().uniform(); })
      .def("normal", [](Given m) { return m.get().normal(); });
}

class PythonModelController final : public ModelController {
 public:
  PythonModelController(std::string file, py::object object) : file_(std::move(file)), object_(std::move(object)) {}

  void tick(Model& model) override {
    lend(model, [&](const py::object& lent) { object_->attr("tick")(lent); });
  }
  void contact(const ModelContact& contact, Model& model) override {
    lend(model, [&](const py::object& lent) {
      if (py::hasattr(*object_, "contact"))
        object_->attr("contact")(OwnedContact{std::string(contact.name), contact}, lent);
    });
  }
  double range() const override {
    return in_python(file_, [&] {
      if (!py::hasattr(*object_, "range")) return 0.0;
      const py::object range = object_->attr("range")();
      if (!py::isinstance<py::float_>(range) && !py::isinstance<py::int_>(range))
        throw std::runtime_error(place_of(object_->attr("range")) + "range() returned " + object_text(py::repr(range)) +
                                 "; expected a number");
      return range.cast<double>();
    });
  }

 private:
  template <class Call>
  void lend(Model& model, Call&& call) {
    in_python(file_, [&] {
      const auto ended = std::make_shared<bool>(false);
      struct Return {
        bool& ended;
        ~Return() { ended = true; }
      } const give_back{*ended};
      const py::object lent = py::cast(LentModel{{&model, ended}});
      call(lent);
    });
  }

  std::string file_;
  HeldObject object_;
};

}  // namespace

void add_model_types(py::module_& module) {
  py::class_<ModelSite>(module, "ModelSite", py::module_local(), "A model at the start: metres, radians, m/s, rad/s.")
      .def_readonly("name", &ModelSite::name)
      .def_readonly("row", &ModelSite::row)
      .def_readonly("pose", &ModelSite::pose)
      .def_readonly("radius", &ModelSite::radius)
      .def_readonly("max_forward", &ModelSite::max_forward)
      .def_readonly("max_turn", &ModelSite::max_turn)
      .def_readonly("interval", &ModelSite::interval)
      .def_readonly("seed", &ModelSite::seed)
      .def_readonly("world", &ModelSite::world);
  py::class_<OwnedRobot>(module, "NearRobot", py::module_local(), "A robot near a model.")
      .def_readonly("name", &OwnedRobot::name)
      .def_property_readonly("row", [](const OwnedRobot& r) { return r.robot.row; })
      .def_property_readonly("pose", [](const OwnedRobot& r) { return r.robot.pose; })
      .def_property_readonly("velocity", [](const OwnedRobot& r) { return r.robot.velocity; })
      .def_property_readonly("radius", [](const OwnedRobot& r) { return r.robot.radius; })
      .def_property_readonly("distance", [](const OwnedRobot& r) { return r.robot.distance; });
  py::class_<OwnedContact>(module, "ModelContact", py::module_local(), "The beginning of a contact of a model.")
      .def_readonly("name", &OwnedContact::name)
      .def_property_readonly("row",
                             [](const OwnedContact& c) {
                               return c.contact.row == kNone ? py::object(py::none())
                                                             : py::object(py::int_(c.contact.row));
                             })
      .def_property_readonly("robot", [](const OwnedContact& c) { return c.contact.robot; })
      .def_property_readonly("point", [](const OwnedContact& c) { return py::make_tuple(c.contact.x, c.contact.y); });
  add_object(module), add_model(module);
}

ModelEntry model_entry_of(py::handle type) {
  ModelEntry entry;
  entry.name = type.attr("__name__").cast<std::string>();
  entry.summary = first_line(type.attr("__doc__"));
  type.inc_ref();  // for the rest of the program
  entry.make = [type, file = file_of(type)](const ModelSite& site, Settings& settings) {
    return in_python(file, [&]() -> std::unique_ptr<ModelController> {
      check_constructor(type, "model");
      py::object object = with_settings(settings, type, py::cast(site));
      check_method(object, "tick", "(self, model)", 1);
      check_method(object, "contact", "(self, contact, model)", 2);
      check_method(object, "range", "(self)", 0);
      return std::make_unique<PythonModelController>(file, std::move(object));
    });
  };
  return entry;
}

}  // namespace sensorfarm::python
