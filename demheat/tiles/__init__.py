"""Parts of a body that are made by themselves: slabs, what each sees of its neighbours, and their cells."""
