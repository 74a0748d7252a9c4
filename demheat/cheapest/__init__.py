"""The cheapest way to an accuracy: what each method's error and cost will be, before anything is solved."""
