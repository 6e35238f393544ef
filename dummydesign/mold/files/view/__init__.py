"""The one view of solids in a page: triangles packed small, and the canvas that shows them."""
