"""Loop conventions of robot files, one module each: what URDF and SDF say in dialects, or beside."""

from vincula.files.dialects.registry import SideFile, loop_readers, reader_of_element

__all__ = ["SideFile", "loop_readers", "reader_of_element"]
